// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { choose, cursorOf, json, kStart, refusal, useBrowser, visit } from './browser';

useBrowser();

const kHash = '#1&s=Vision/RGB/head/stereo&p=nights;inspector';

describe('the quality of an entity', () => {
  it('is a distribution whose bars lead to their worst snapshot', async () => {
    const { page } = await visit({ hash: kHash });
    const part = page.getByLabel('Quality of Vision/RGB/head/stereo');
    await part.getByText(/^64 of 200 snapshots compared in both forms\. /).waitFor();
    const bars = part.locator('.quality-bar');
    expect(await bars.count()).toBeGreaterThan(5);
    expect(await bars.first().getAttribute('aria-label')).toMatch(/^\d\d\.\d to \d\d\.\d dB: \d+ snapshots?; go to the worst of them$/);
    const worst = part.getByRole('list', { name: 'Worst snapshots' }).getByRole('button');
    expect(await worst.count()).toBe(20);
    const timeOf = async (i: number) => BigInt((await worst.nth(i).getAttribute('title'))!.split('/').at(-1)!);
    await bars.first().click();
    expect(await cursorOf(page)).toBe(await timeOf(0));
    await worst.nth(3).click();
    expect(await cursorOf(page)).toBe(await timeOf(3));
    // A bar of good snapshots has none that is named, so it leads to the worst of all.
    await bars.last().click();
    expect(await cursorOf(page)).toBe(await timeOf(0));
    expect(Number((await timeOf(0)) - kStart) / 1e9).toBeGreaterThan(600);
  });

  it('is walked by keys', async () => {
    const { page } = await visit({ hash: kHash });
    const part = page.getByLabel('Quality of Vision/RGB/head/stereo');
    await part.locator('.quality-bar').first().focus();
    await page.keyboard.press('ArrowRight');
    expect(await part.locator('.quality-bar').nth(1).evaluate((bar) => document.activeElement === bar)).toBe(true);
    const before = await cursorOf(page);
    await page.keyboard.press(' ');
    expect(await cursorOf(page)).not.toBe(before);
    expect(await page.getByRole('button', { name: 'Pause' }).count()).toBe(0);
  });

  it('is asked for where both forms are kept alone, and says why there is none', async () => {
    const { page, mock } = await visit({ hash: kHash, expected: /409/ });
    await page.getByLabel('Quality of Vision/RGB/head/stereo').locator('.quality-bar').first().waitFor();
    await choose(page, 'battery');
    await expect.poll(() => page.locator('.quality').count()).toBe(0);
    await choose(page, 'joints');
    await page.getByLabel('Quality of RobotState/Proprioception/robot/joints').getByText(/has no image/).waitFor();
    expect(await page.getByRole('alert').count()).toBe(0);
    mock.state.intercept = (url) => (url.pathname === '/api/quality' ? json({ entity: 'A/B/C/D', low: 0, step: 0.5, counts: [], compared: 0, asked: 9, unknown: 9, worst: [] }) : null);
    await choose(page, 'platform');
    await page.getByText('9 snapshots are kept in both forms, but none of them could be compared').waitFor();
    expect(mock.state.requests.filter((request) => request.startsWith('/api/quality') && request.includes('battery'))).toEqual([]);
  });

  it('that fails is said, and asked for again', async () => {
    let isBroken = true;
    const { page } = await visit({ hash: kHash, expected: /500/, intercept: (url) => (isBroken && url.pathname === '/api/quality' ? refusal(500, 'data loss', 'checksum 5 found, 6 needed') : null) });
    const part = page.getByLabel('Quality of Vision/RGB/head/stereo');
    await part.getByRole('alert').getByText(/checksum 5 found/).waitFor();
    isBroken = false;
    await part.getByRole('button', { name: 'Try again' }).click();
    await part.locator('.quality-bar').first().waitFor();
  });
});
