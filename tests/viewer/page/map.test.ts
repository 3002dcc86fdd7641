// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { choose, cursorOf, goTo, kStart, useBrowser, visit } from './browser';

useBrowser();

const kHash = '#1&s=Vision/RGB/head/stereo&p=map~Vision/RGB/head/stereo;inspector';

describe('the memory map', () => {
  it('shows moments as points, tells which is below the pointer, and goes there', async () => {
    const { page, mock } = await visit();
    await choose(page, 'stereo');
    await page.keyboard.press('m');
    const panel = page.locator('[data-panel=map]');
    await panel.getByText(/^2 000 of \d\d \d{3} moments by images, 41 % of their variance$/).waitFor();
    expect(mock.state.requests.find((request) => request.startsWith('/api/map'))).toBe('/api/map?entity=Vision%2FRGB%2Fhead%2Fstereo&max=2000');
    const canvas = panel.locator('canvas').first();
    await canvas.scrollIntoViewIfNeeded();
    const box = (await canvas.boundingBox())!;
    const told = panel.locator('.map-told');
    // Somewhere along the middle there is a moment.
    for (let x = 0.2; x < 0.9 && (await told.count()) === 0; x += 0.02) await page.mouse.move(box.x + box.width * x, box.y + box.height * 0.5);
    await told.locator('.thumb-picture canvas').waitFor();
    const clock = (await told.locator('b').textContent())!;
    await page.mouse.down();
    await page.mouse.up();
    await expect.poll(() => page.locator('.clock').textContent()).toContain(clock);
  });

  it('is walked by keys in the order of time', async () => {
    const { page } = await visit({ hash: kHash });
    await goTo(page, '07:05:00');
    const map = page.getByRole('slider', { name: 'Moments of the map' });
    await map.focus();
    const at = async () => Number(await map.getAttribute('aria-valuenow'));
    const first = await at();
    expect(await map.getAttribute('aria-valuetext')).toMatch(/^2026-01-01 07:0[45]:\d\d\.\d+, recording 1 of 2$/);
    await page.keyboard.press('ArrowRight');
    expect(await at()).toBe(first + 1);
    await page.keyboard.press('Shift+ArrowRight');
    expect(await at()).toBe(first + 11);
    await page.keyboard.press('ArrowLeft');
    const before = await cursorOf(page);
    await page.keyboard.press('Enter');
    await expect.poll(() => cursorOf(page)).toBeGreaterThan(before);
    await page.keyboard.press('Home');
    expect(await at()).toBe(0);
  });

  it('is coloured by recording on request, which the address keeps', async () => {
    const { page, context } = await visit({ hash: kHash });
    const panel = page.locator('[data-panel=map]');
    await panel.getByRole('button', { name: 'Recording' }).click();
    await panel.locator('.map-legend').getByText('recording 2').waitFor();
    await expect.poll(() => new URL(page.url()).hash).toContain('colour.recording');
    const other = await context.newPage();
    await other.goto(page.url());
    await expect.poll(() => other.getByRole('button', { name: 'Recording' }).getAttribute('aria-pressed')).toBe('true');
  });

  it('is a table, too', async () => {
    const { page } = await visit({ hash: kHash });
    const panel = page.locator('[data-panel=map]');
    await panel.getByRole('button', { name: 'Show as a table' }).click();
    await expect.poll(() => panel.locator('tbody tr').count()).toBe(100);
    await panel.locator('tbody th button').nth(10).click();
    expect(Number((await cursorOf(page)) - kStart) / 1e9).toBeLessThan(200);
  });

  it.each([['PNG', 'map.png'], ['SVG', 'map.svg']])('is saved as %s', async (kind, name) => {
    const { page } = await visit({ hash: kHash });
    await page.getByRole('slider', { name: 'Moments of the map' }).waitFor();
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: `Save this map as ${kind}` }).click();
    const file = await waiting;
    expect(file.suggestedFilename()).toBe(name);
    const bytes = readFileSync(await file.path());
    if (kind === 'PNG') expect([...bytes.subarray(1, 4)]).toEqual([...Buffer.from('PNG')]);
    else expect(bytes.toString()).toMatch(/<title>Memory map of Vision\/RGB\/head\/stereo<\/title>[^]*<path[^]*07:00:00/);
  });

  it('says why there is none', async () => {
    const { page } = await visit({ hash: '#1&s=Speech/Commands/human/text&p=map~Speech/Commands/human/text;inspector', expected: /409/ });
    await page.locator('[data-panel=map]').getByRole('alert').getByText(/has no codes yet/).waitFor();
  });

  it('with lists that do not fit together is refused', async () => {
    const answer = { status: 200, type: 'application/json', headers: {}, body: JSON.stringify({ times: ['5'], x: [], y: [1] }) };
    const { page } = await visit({ hash: kHash, intercept: (url) => (url.pathname === '/api/map' ? answer : null) });
    await page.locator('[data-panel=map]').getByRole('alert').getByText(/as many numbers as there are times/).waitFor();
  });
});
