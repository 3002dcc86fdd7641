// SPDX-License-Identifier: Apache-2.0
// What a person who asks the memory in words sees.
import { describe, expect, it } from 'vitest';
import { axeSource, cursorOf, json, kStart, useBrowser, visit, type Answer } from './browser';

useBrowser();

const kSaid = 'Speech/Commands/human/text/2026-01-01 07:00:00.500000/0';
const kEvent = 'Skills/Actions/robot/pick/2026-01-01 07:00:02.000000/0';

/** Answers as `engram ask --json` and `engram tell --json` do. */
function answers(url: URL): Answer | null {
  if (url.pathname === '/api/ask') {
    const question = url.searchParams.get('q') ?? '';
    const isKnown = !question.includes('elephant');
    return json({
      question, route: isKnown ? 'program' : 'none', confidence: isKnown ? 0.9 : 0, took_ms: 12.3, program: isKnown ? 'executions skill=pick | last | why' : null,
      text: isKnown ? 'I picked up the salt because Ada asked for it.' : 'I do not know.', looked_for: isKnown ? '' : 'a thing called elephant',
      value: { kind: isKnown ? 'reason' : 'unknown' },
      evidence: isKnown ? [{ id: kEvent, role: 'event' }, { id: kSaid, role: 'command' }, ...Array.from({ length: 20 }, (_, i) => ({ id: `Skills/Actions/robot/pick/2026-01-01 07:00:${10 + i}.000000/0`, role: 'event' }))] : [],
    });
  }
  if (url.pathname === '/api/tell') {
    return json({ sentences: [
      { level: 'whole', text: 'I was asked for one thing.', links: [kSaid] },
      { level: 'plan', text: 'I brought the salt.', links: [kEvent] },
      { level: 'failure', text: 'The first grasp failed.', links: [kEvent] },
    ] });
  }
  return null;
}

async function open() {
  const visited = await visit({ intercept: answers });
  await visited.page.keyboard.press('a');
  return visited;
}

describe('the panel that is asked', () => {
  it('answers, and opens what the answer rests on', async () => {
    const { page, mock } = await open();
    const panel = page.locator('[data-panel=ask]');
    await panel.getByLabel('Question').fill('Why did you pick up the salt?');
    await panel.getByRole('button', { name: 'Ask', exact: true }).click();
    await panel.getByText('because Ada asked for it').waitFor();
    await panel.getByText('executions skill=pick | last | why').waitFor();
    expect(mock.state.requests.some((one) => one.startsWith('/api/ask?q=Why+did+you+pick+up+the+salt'))).toBe(true);
    expect(await panel.locator('.evidence .chip').count()).toBe(12);
    await panel.getByRole('button', { name: '10 more' }).click();
    expect(await panel.locator('.evidence .chip').count()).toBe(22);
    await panel.getByRole('button', { name: /^Links to Speech/ }).click();
    await expect.poll(() => cursorOf(page)).toBe(kStart + 500_000_000n);
    // It is in the address, so that a copied link asks the same.
    await expect.poll(() => decodeURIComponent(new URL(page.url()).hash)).toContain('q.Why');
  });

  it('says that it does not know, and what it looked for', async () => {
    const { page } = await open();
    const panel = page.locator('[data-panel=ask]');
    await panel.getByLabel('Question').fill('Where is the elephant?');
    await panel.getByLabel('Question').press('Enter');
    await panel.getByText('I do not know.').waitFor();
    await panel.getByText('Looked for a thing called elephant.').waitFor();
    expect(await panel.locator('.chip').count()).toBe(0);
  });

  it('tells the stretch of time on the screen', async () => {
    const { page, mock } = await open();
    const panel = page.locator('[data-panel=ask]');
    await panel.getByRole('button', { name: 'Tell this stretch' }).click();
    await panel.getByText('I brought the salt.').waitFor();
    expect(await panel.locator('.narration li').count()).toBe(3);
    const told = () => mock.state.requests.filter((one) => one.startsWith('/api/tell'));
    expect(told()).toHaveLength(1);
    // Another stretch is told anew, once the screen rests.
    for (let i = 0; i < 3; ++i) await page.keyboard.press('+');
    await expect.poll(() => told().length).toBe(2);
    expect(told()[0]).not.toBe(told()[1]);
  });

  it('offers questions, and has no barriers', async () => {
    const { page } = await open();
    const panel = page.locator('[data-panel=ask]');
    await panel.getByRole('button', { name: 'What went wrong?' }).click();
    await panel.locator('.answer-text').waitFor();
    await page.evaluate(axeSource());
    const found = await page.evaluate(async () => (await (window as unknown as { axe: { run: (where: string) => Promise<{ violations: { id: string }[] }> } }).axe.run('[data-panel=ask]')).violations.map((one) => one.id));
    expect(found).toEqual([]);
  });
});
