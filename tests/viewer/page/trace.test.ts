// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { choose, goTo, refusal, useBrowser, visit } from './browser';

useBrowser();

describe('the trace of a snapshot', () => {
  it('leads from causes on the left to consequences on the right, by clicks and by keys', async () => {
    const { page, mock } = await visit();
    await choose(page, 'plan');
    await goTo(page, '07:12:12');
    const trace = page.locator('details.trace');
    expect(mock.state.requests.filter((request) => request.startsWith('/api/links')).length).toBeLessThan(4);
    await trace.getByText('Trace').click();
    await trace.getByRole('group', { name: /^Trace: \d+ snapshots/ }).waitFor();
    const node = (name: RegExp) => trace.getByRole('button', { name });
    await expect.poll(() => node(/this snapshot, Tasks\/Plans/).count()).toBe(1);
    await expect.poll(() => trace.getByText('following links').count()).toBe(0);
    const x = async (name: RegExp) => (await node(name).first().boundingBox())!.x;
    expect(await x(/go to Speech\/Commands/)).toBeLessThan(await x(/this snapshot/));
    expect(await x(/go to Skills\/Actions\/robot\/pick/)).toBeGreaterThan(await x(/this snapshot/));
    expect(await trace.locator('.trace-edge title').allTextContents()).toContainEqual(expect.stringMatching(/^Tasks\/Plans\/robot\/plan\/\d+ links to Speech\/Commands\/human\/text\/\d+\ncommand$/));
    await node(/this snapshot/).focus();
    await page.keyboard.press('ArrowLeft');
    expect(await page.evaluate(() => document.activeElement?.getAttribute('aria-label'))).toMatch(/go to Speech/);
    await page.keyboard.press('Enter');
    const inspector = page.getByLabel(/^Inspector/);
    await expect.poll(() => inspector.locator('.entity-path').textContent()).toBe('Speech/Commands/human/text');
    // The focus goes along, so that the next step is a key, too.
    await expect.poll(() => page.evaluate(() => document.activeElement?.getAttribute('aria-label'))).toMatch(/this snapshot, Speech/);
    await node(/go to Tasks\/Plans/).click();
    await expect.poll(() => inspector.locator('.entity-path').textContent()).toBe('Tasks/Plans/robot/plan');
    await expect.poll(() => new URL(page.url()).hash).toContain('trace.1');
  });

  it('is cut off at a number of snapshots, and says so', async () => {
    const { page } = await visit({
      intercept: (url) => (url.pathname === '/api/links' ? { status: 200, type: 'application/json', headers: {}, body: JSON.stringify({ to: [], from: Array.from({ length: 30 }, (_, i) => `A/B/C/x${i}/${i + 1}`) }) } : null),
    });
    const trace = page.locator('details.trace');
    await trace.getByText('Trace').click();
    await trace.getByText(/^Cut off: \d+ more links are not shown/).waitFor();
    expect(await trace.locator('.trace-node').count()).toBe(24);
  });

  it('says what went wrong, and tries again', async () => {
    let isBroken = true;
    const { page } = await visit({ expected: /500/, intercept: (url) => (isBroken && url.pathname === '/api/links' ? refusal(500, 'data loss', 'checksum 5 found, 6 needed') : null) });
    const trace = page.locator('details.trace');
    await trace.getByText('Trace').click();
    await trace.getByRole('alert').getByText(/checksum 5 found/).waitFor();
    isBroken = false;
    await trace.getByRole('button', { name: 'Try again' }).click();
    await trace.getByRole('group', { name: /^Trace/ }).waitFor();
  });

  it('of a snapshot without links says so', async () => {
    const { page } = await visit({ hash: '#1&s=Vision/RGB/head/stereo&p=inspector~~~trace.1' });
    await choose(page, 'battery');
    await page.locator('details.trace').getByText('This snapshot links to nothing').waitFor();
  });
});
