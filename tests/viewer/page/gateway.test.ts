// SPDX-License-Identifier: Apache-2.0
// The page that is in the program, as a running `engram view` of a kitchen shows it: its own policy,
// its own numbers. page_test.py starts it and says where it is.
import { describe, expect, it } from 'vitest';
import { choose, coloursOf, pixelsOf, useBrowser, visit, type VisitOptions } from './browser';

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

  it('has its robot in the scene, with its eyes where the images were seen from', async () => {
    const { page } = await visit(options);
    await choose(page, 'stereo');
    await page.keyboard.press('Home');
    // Two seconds later it drives and looks around.
    for (let i = 0; i < 40; ++i) await page.keyboard.press('ArrowRight');
    await page.keyboard.press('3');
    const panel = page.locator('[data-panel=scene]');
    await expect.poll(() => panel.locator('.scene').getAttribute('aria-label'), kFirst).toContain('and a robot');
    await panel.getByText(/^left: \d[\d\s]* points\.$/).waitFor(kFirst);
    await panel.getByRole('button', { name: 'Show places as a table' }).click();
    const places = async (row: string) => (await panel.locator('tbody tr').filter({ has: page.getByText(row, { exact: true }) }).locator('td').allTextContents()).slice(0, 3).map((text) => Number(text.replace('−', '-')));
    await expect.poll(async () => {
      const [link, seen] = [await places('left_camera'), await places('Vision/RGB/head/stereo')];
      return link.length === 3 && seen.length === 3 ? Math.hypot(...link.map((x, i) => x - seen[i]!)) : Infinity;
    }, kFirst).toBeLessThan(0.001);
    const [platform, torso, hand] = [await places('platform'), await places('torso'), await places('left_hand')];
    expect(Math.hypot(torso[0]! - platform[0]!, torso[1]! - platform[1]!)).toBeCloseTo(0.04, 3);
    // A hand is at most an arm's length from its shoulder, and above the floor.
    expect(Math.hypot(hand[0]! - torso[0]!, hand[1]! - torso[1]!, hand[2]! - torso[2]! - 0.42)).toBeLessThan(0.9);
    expect(hand[2]).toBeGreaterThan(0.3);
    expect(await panel.getByText(/not told|not drawn|origin/).count()).toBe(0);
  });

  it('has the cost map of what stands in it', async () => {
    const { page } = await visit(options);
    await page.keyboard.press('3');
    const panel = page.locator('[data-panel=scene]');
    await panel.getByText(/^Cost map navigation\/floor of \d\d:\d\d:\d\d\.\d{3}: 10 x 10 m\.$/).waitFor(kFirst);
    // Obstacles, and where the robot would touch them.
    await expect.poll(() => pixelsOf(page, [255, 0, 255]), kFirst).toBeGreaterThan(30);
    await expect.poll(() => pixelsOf(page, [0, 255, 255]), kFirst).toBeGreaterThan(30);
  });

  it('has the ghost of its robot in the future', async () => {
    const { page } = await visit(options);
    await page.keyboard.press('3');
    const panel = page.locator('[data-panel=scene]');
    await panel.getByRole('button', { name: 'Show places as a table' }).click();
    await panel.getByText('left_hand', { exact: true }).waitFor(kFirst);
    await page.locator('h1').click();
    await page.keyboard.press('f');
    await panel.getByText('left_hand, predicted', { exact: true }).waitFor(kFirst);
    await panel.getByText('left_hand', { exact: true }).waitFor();
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
