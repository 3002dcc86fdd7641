// SPDX-License-Identifier: Apache-2.0
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { choose, clockTime, coloursOf, cursorOf, kStart, useBrowser, viewOf, visit } from './browser';

useBrowser();

const kRecorded = '0,114,178';
const kLatent = '230,159,0';

/** Turns the wheel many times, a frame for each: the driver waits a second for every turn of its own. */
const turn = (page: Page, share: number, deltaY: number, times: number) =>
  page.getByTestId('surface').evaluate(async (surface, [at, delta, count]) => {
    const box = surface.getBoundingClientRect();
    for (let i = 0; i < count!; ++i) {
      surface.dispatchEvent(new WheelEvent('wheel', { deltaY: delta!, clientX: box.x + box.width * at!, clientY: box.y + 120, bubbles: true, cancelable: true }));
      await new Promise((done) => requestAnimationFrame(done));
    }
  }, [share, deltaY, times]);

describe('the timeline', () => {
  it('shows a lane for each entity, in the colours of where its snapshots are kept', async () => {
    const { page } = await visit();
    const names = page.getByRole('tree', { name: 'Entities' });
    await names.getByRole('treeitem', { name: /stereo/ }).waitFor();
    await expect.poll(() => coloursOf(page, '.lanes-canvas')).toEqual(expect.arrayContaining([kRecorded, kLatent]));
    expect(await page.locator('.timeline-corner').textContent()).toContain('32 lanes');
  });

  it('collapses a segment and opens it again', async () => {
    const { page } = await visit();
    const vision = page.getByRole('treeitem', { name: /^Vision/ });
    const left = page.getByRole('treeitem', { name: /head \/ stereo/ });
    await vision.click();
    await expect.poll(() => left.count()).toBe(0);
    expect(await vision.getAttribute('aria-expanded')).toBe('false');
    await vision.click();
    await left.waitFor();
  });

  it('zooms from a life to less than a millisecond, and the time below the pointer stays', async () => {
    const { page } = await visit();
    const surface = page.getByTestId('surface');
    const box = (await surface.boundingBox())!;
    const x = box.x + box.width * 0.4;
    const before = await viewOf(page);
    const anchor = before.from + (before.length * 400n) / 1000n;
    await page.mouse.move(x, box.y + 120);
    await page.mouse.wheel(0, -300);
    await turn(page, 0.4, -300, 40);
    const after = await viewOf(page);
    expect(after.length).toBeLessThan(1_000_000n);
    const share = Number(anchor - after.from) / Number(after.length);
    // A pixel of the whole life is a second, so the pointer itself is not more exact.
    expect(Math.abs(Number(after.from - anchor))).toBeLessThan(2e9);
    expect(Number.isFinite(share)).toBe(true);
    await turn(page, 0.4, 300, 42);
    expect((await viewOf(page)).length).toBe(before.length);
  });

  it('moves by dragging, and by the frame in the overview', async () => {
    const { page } = await visit();
    const surface = page.getByTestId('surface');
    const box = (await surface.boundingBox())!;
    await turn(page, 0.5, -300, 3);
    await page.mouse.move(box.x + 500, box.y + 120);
    const before = await viewOf(page);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 120, { steps: 5 });
    await page.mouse.up();
    const dragged = await viewOf(page);
    expect(dragged.length).toBe(before.length);
    expect(dragged.from).toBeGreaterThan(before.from);
    const map = (await page.locator('.minimap').boundingBox())!;
    await page.mouse.click(map.x + map.width * 0.1, map.y + 10);
    expect((await viewOf(page)).from).toBeLessThan(before.from);
  });

  it('zooms by two fingers', async () => {
    const { page } = await visit();
    const before = await viewOf(page);
    await page.getByTestId('surface').evaluate((element) => {
      const box = element.getBoundingClientRect();
      const send = (type: string, pointerId: number, x: number) =>
        element.dispatchEvent(new PointerEvent(type, { pointerId, bubbles: true, clientX: box.x + x, clientY: box.y + 100, button: 0, pointerType: 'touch' }));
      element.setPointerCapture = () => {};
      send('pointerdown', 11, 400);
      send('pointerdown', 12, 500);
      for (let i = 1; i <= 10; ++i) send('pointermove', 12, 500 + i * 20);
      send('pointerup', 11, 400);
      send('pointerup', 12, 700);
    });
    const after = await viewOf(page);
    expect(Number(after.length) / Number(before.length)).toBeCloseTo(1 / 3, 1);
  });

  it('pins one cursor for all panels, with a hover cursor beside it', async () => {
    const { page } = await visit();
    const box = (await page.getByTestId('surface').boundingBox())!;
    await page.mouse.click(box.x + box.width * 0.3, box.y + 60);
    const pinned = await cursorOf(page);
    expect(Number(pinned - kStart) / 1e9).toBeGreaterThan(300);
    const inspector = page.getByLabel(/^Inspector/);
    await expect.poll(() => inspector.locator('.facts').first().textContent()).toContain('07:07');
    await page.mouse.move(box.x + box.width * 0.5, box.y + 60);
    await expect.poll(() => page.locator('.plot-line.hovering').first().evaluate((line) => getComputedStyle(line).visibility)).toBe('visible');
    expect(await cursorOf(page)).toBe(pinned);
    const [pin, hover] = await Promise.all(['.pinned', '.hovering'].map((name) => page.locator(`.plot-line${name}`).first().boundingBox()));
    expect(hover!.x).toBeGreaterThan(pin!.x + 20);
  });

  it('draws the links of the chosen snapshot between lanes', async () => {
    const { page } = await visit();
    await choose(page, 'stereo');
    await expect.poll(() => page.getByRole('button', { name: /^Links to RobotState\/Proprioception/ }).count()).toBeGreaterThan(0);
    // Links are drawn in the ink of the text, which nothing else on that canvas below the axis has.
    const hasInk = () => page.locator('.overlay-canvas').evaluate((element) => {
      const canvas = element as HTMLCanvasElement;
      const { data } = canvas.getContext('2d')!.getImageData(0, 30, canvas.width, canvas.height - 30);
      for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 90 && data[i]! < 60 && data[i + 1]! < 60 && data[i + 2]! < 60) return true;
      return false;
    });
    await expect.poll(hasInk).toBe(true);
  });

  it('makes of a selection a command of engram export', async () => {
    const { page } = await visit();
    const box = (await page.getByTestId('surface').boundingBox())!;
    await page.keyboard.down('Shift');
    await page.mouse.move(box.x + 200, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 400, box.y + 100, { steps: 4 });
    await page.mouse.up();
    await page.keyboard.up('Shift');
    expect(await page.evaluate(() => String(getSelection()))).toBe('');
    await page.getByRole('button', { name: 'Copy engram export' }).click();
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    expect(copied).toMatch(/^engram export \/data\/kitchen\.engram 'Vision\/RGB\/head\/stereo @ 2026-01-01 07:0\d:\d\d\.\d+\.\.2026-01-01 07:0\d:\d\d\.\d+' --to jsonl -o exported$/);
    await page.getByRole('button', { name: 'Clear the selection' }).click();
    expect(await page.getByRole('button', { name: 'Copy engram export' }).count()).toBe(0);
  });

  it('says the time of the cursor to nine digits', async () => {
    const { page } = await visit();
    expect(await clockTime(page).textContent()).toContain('07:22:59.983307030');
  });
});
