// SPDX-License-Identifier: Apache-2.0
// The page that is in the program, as a running `engram view` of a kitchen shows it: its own policy,
// its own numbers. page_test.py starts it and says where it is.
import { describe, expect, it } from 'vitest';
import { choose, coloursOf, useBrowser, visit, type VisitOptions } from './browser';

const url = process.env.VIEW_URL;
/** The first questions load models, learn, and code images; others of that kind wait for them. */
const kFirst = { timeout: 100_000 };
// A form that a snapshot does not have is an answer, too.
const options: VisitOptions = { url: url ?? '', expected: /404/ };

useBrowser();

describe.skipIf(!url)('a kitchen behind its gateway', () => {
  it('has its lanes, its numbers and its images', async () => {
    const { page } = await visit(options);
    await page.getByText(/^\d+ entities · [\d\s]+ snapshots$/).waitFor();
    await page.getByText('RGB / head / stereo').waitFor();
    await page.locator('[data-panel=plot] .plot-host canvas').first().waitFor();
    const images = page.locator('[data-panel=images]');
    await images.locator('canvas').first().waitFor();
    await expect.poll(async () => (await coloursOf(page, '[data-panel=images] canvas')).length).toBeGreaterThan(100);
  });

  it('has both forms of an image and how they differ', async () => {
    const { page } = await visit(options);
    await choose(page, 'stereo');
    await page.keyboard.press('Home');
    await page.keyboard.press('Shift+ArrowRight');
    await page.keyboard.press('i');
    const images = page.locator('[data-panel=images]').filter({ has: page.getByText('Vision/RGB/head/stereo') });
    for (const title of ['Recorded', 'Reconstructed', 'Error map']) await images.getByText(title, { exact: true }).waitFor(kFirst);
    await expect.poll(() => images.locator('canvas').count(), kFirst).toBe(3);
    await expect.poll(() => images.locator('figcaption').nth(1).textContent(), kFirst).toMatch(/\d+\.\d dB/);
  });

  it('is predicted behind its last snapshot', async () => {
    const { page } = await visit(options);
    await choose(page, 'joints');
    await page.keyboard.press('f');
    const facts = page.getByLabel(/^Inspector/).locator('.facts').first();
    await expect.poll(() => facts.textContent(), kFirst).toMatch(/predicted.*Horizon\+\d+ ms/s);
  });

  it('tells what is not there, and goes on', async () => {
    const { page } = await visit(options);
    await page.keyboard.press('q');
    const panel = page.locator('[data-panel=query]');
    await panel.getByLabel('Query', { exact: true }).fill('Nothing/At/All @ latest');
    await page.keyboard.press('Enter');
    await panel.getByRole('alert').getByText(/no entity matches/).waitFor(kFirst);
    await panel.getByLabel('Query', { exact: true }).fill('Speech @ latest');
    await page.keyboard.press('Enter');
    await expect.poll(() => panel.locator('tbody tr').count(), kFirst).toBe(1);
  });
});
