// SPDX-License-Identifier: Apache-2.0
// The page that is in the program, as a running `engram view` of a kitchen shows it: its own policy,
// its own numbers. page_test.py starts it and says where it is.
import { describe, expect, it } from 'vitest';
import { choose, coloursOf, useBrowser, visit, type VisitOptions } from './browser';

const url = process.env.VIEW_URL;
/** The first questions load models, learn, and code images; others of that kind wait for them. */
const kFirst = { timeout: 100_000 };
// A form that a snapshot does not have is an answer, too, and so is what is wrong in a form.
const options: VisitOptions = { url: url ?? '', expected: /40[04]/ };

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

  it('tells what its night did, what is odd in it, and what forgetting would do', async () => {
    const { page, context } = await visit(options);
    await context.grantPermissions(['clipboard-read', 'clipboard-write']);
    await page.keyboard.press('n');
    const panel = page.locator('[data-panel=nights]');
    const kept = async (name: string) => Number((await panel.locator('.bytes tr', { has: page.getByRole('button', { name, exact: true }) }).locator('td').first().textContent())!.replace(/\s/g, ''));
    await panel.getByText(/plain, kept in/).waitFor(kFirst);
    const joints = await kept('RobotState/Proprioception/robot/joints');
    const images = await kept('Vision/RGB/head/stereo');
    await panel.getByRole('button', { name: 'Nights', exact: true }).click();
    await panel.locator('.night-head').click();
    const row = panel.locator('.night-table tbody tr');
    await row.getByText(/^\d\d\.\d dB$/).first().waitFor(kFirst);
    expect(await row.count()).toBe(1);
    expect((await row.textContent())!.replace(/\s/g, '')).toMatch(new RegExp(`^Vision/RGB/head/stereo.*${images}.*\\+v1$`));
    await panel.getByText('No reflection was recorded after this night').waitFor(kFirst);
    await panel.getByRole('button', { name: 'Reflection' }).click();
    await panel.getByText('No reflection yet').waitFor(kFirst);
    await panel.getByRole('button', { name: 'Look now' }).click();
    await panel.getByText(/which is not recorded/).waitFor(kFirst);
    await panel.getByRole('button', { name: 'Forgetting' }).click();
    await panel.getByLabel('Entities').fill('RobotState/Proprioception');
    await panel.getByLabel('Go when older than').fill('0s');
    await panel.getByLabel('Keep the newest').fill('3');
    await page.keyboard.press('Enter');
    const first = panel.locator('.plan tbody tr').nth(1);
    await first.waitFor(kFirst);
    expect(await first.locator('th').textContent()).toBe('RobotState/Proprioception/robot/joints');
    expect((await first.locator('td').nth(1).textContent())!.replace(/\s/g, '')).toBe(String(joints - 3));
    expect(await first.locator('td').nth(3).textContent()).toBe('3');
    await panel.getByRole('button', { name: 'Copy engram forget' }).click();
    expect(await page.evaluate(() => navigator.clipboard.readText())).toMatch(/older_than: 0s[^]*newest: 3\nEND\nengram forget \S+kitchen\.engram --config forget\.yaml$/);
    await panel.getByLabel('Store at most').fill('little');
    await page.keyboard.press('Enter');
    await panel.getByRole('alert').getByText("“Store at most”: found 'little', needs a size such as 500MB or 20GiB").waitFor(kFirst);
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
