// SPDX-License-Identifier: Apache-2.0
// What a person sees of navigation in the scene: cost maps, plans, and places.
import { describe, expect, it } from 'vitest';
import { goTo, kStart, pixelsOf, useBrowser, visit, type Answer } from './browser';
// @ts-expect-error The mock is plain JavaScript.
import { kExecutions, kNavigation, withSkills } from '@mock/skills.mjs';

useBrowser();

const at = (s: number) => (kStart + BigInt(Math.round(s * 1e3)) * 1_000_000n).toString(36);

async function open(seconds: number, more: readonly unknown[] = kNavigation) {
  const visited = await visit({ hash: `#1&t=${at(seconds)}&s=Navigation/Plan/robot/drive&h=150&p=inspector;scene~~~p.0`, expected: /404/, intercept: withSkills({ executions: kExecutions, more }) as (url: URL) => Answer | null });
  const panel = visited.page.locator('[data-panel=scene]');
  await panel.locator('canvas').waitFor();
  return { ...visited, panel, notes: panel.getByLabel('Notes on the scene') };
}

const kMagenta = [255, 0, 255] as const;
const kCyan = [0, 255, 255] as const;
const kAccent = [11, 93, 143] as const;

describe('a cost map', () => {
  it('lies on the floor in the colours of RViz, and is taken away', async () => {
    const { page, panel, notes, mock } = await open(701);
    await notes.getByText('Cost map kitchen/floor of 07:11:30.000: 3 x 2 m.').waitFor();
    await notes.getByText("The map left something out: 'vase_1' has no class.").waitFor();
    await expect.poll(() => pixelsOf(page, kMagenta)).toBeGreaterThan(30);
    expect(await pixelsOf(page, kCyan)).toBeGreaterThan(30);
    await panel.getByLabel('Colours of the cost map').getByText('the robot would touch').waitFor();
    await panel.getByLabel('cost map', { exact: true }).uncheck();
    await expect.poll(() => pixelsOf(page, kMagenta)).toBe(0);
    expect(await panel.getByLabel('Colours of the cost map').count()).toBe(0);
    await panel.getByLabel('cost map', { exact: true }).check();
    await expect.poll(() => pixelsOf(page, kMagenta)).toBeGreaterThan(30);
    // Its costs are asked for once, whatever is shown.
    expect(mock.state.requests.filter((one) => one.startsWith('/api/query') && one.includes('CostMap'))).toHaveLength(1);
  });

  it('that cannot be drawn says why', async () => {
    const odd = kNavigation.map((one: unknown[]) => (String(one[0]).includes('CostMap') ? [one[0], one[1], { ...(one[2] as object), resolution: -1 }] : one));
    const { notes } = await open(701, odd);
    await notes.getByText('The cost map kitchen/floor is not drawn: it does not tell where it is, or how large its cells are.').waitFor();
  });
});

describe('a plan', () => {
  it('is drawn while it holds, and not any more once the drive arrived', async () => {
    const { page, panel, notes } = await open(701);
    await notes.getByText("Plan to 'counter' of 07:11:40.100, 3.05 m.").waitFor();
    await expect.poll(() => pixelsOf(page, kAccent)).toBeGreaterThan(60);
    const drawn = await pixelsOf(page, kAccent);
    await page.locator('h1').click();
    await goTo(page, '07:11:48');
    await notes.getByText("The drive to 'counter' arrived at 07:11:46.000: stands at 'counter'.").waitFor();
    await expect.poll(() => pixelsOf(page, kAccent)).toBeLessThan(drawn / 4);
    await panel.getByLabel('plan', { exact: true }).uncheck();
    await expect.poll(() => notes.getByText('The drive to').count()).toBe(0);
  });

  it('that was refused says why, in the notes and in the inspector', async () => {
    const { page, notes } = await open(725);
    await notes.getByText("No way to 'garden' since 07:12:00.000: no way leads there: the door is closed.").waitFor();
    const meant = page.getByRole('region', { name: 'What was meant' });
    await meant.getByRole('heading', { name: 'Plan to garden, refused' }).waitFor();
    await meant.getByText('no way leads there: the door is closed').waitFor();
  });
});

describe('places', () => {
  it('are flags with their names, and move with what they stand beside', async () => {
    const { page, panel } = await open(701);
    for (const name of ['Ada', 'Shelf']) await panel.locator('.scene-label', { hasText: new RegExp(`^${name}$`) }).waitFor();
    await panel.getByRole('button', { name: 'Show places as a table' }).click();
    const placeOf = async (id: string) => (await panel.locator('tbody tr').filter({ has: page.getByText(id, { exact: true }) }).locator('td').allTextContents()).slice(0, 3);
    expect(await placeOf('Navigation/Location/people/ada')).toEqual(['1.6', '-1.4', '0']);
    expect(await placeOf('Navigation/Location/people/shelf')).toEqual(['1.9', '0.2', '0']);
    await panel.getByLabel('places', { exact: true }).uncheck();
    await expect.poll(() => panel.getByText('Navigation/Location/people/ada').count()).toBe(0);
  });
});
