// SPDX-License-Identifier: Apache-2.0
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { useBrowser, visit } from './browser';

useBrowser();

const kHash = '#1&s=Vision/RGB/head/stereo&p=images~Vision/RGB/head/stereo;plot~RobotState/Proprioception/robot/joints~positions[0];map~Vision/RGB/head/stereo;inspector;similar~Vision/RGB/head/stereo';
const kindsOf = (page: Page, where: string) => page.locator(`${where} [data-panel]`).evaluateAll((all) => all.map((one) => one.getAttribute('data-panel')));

/** Holds a title bar and moves it over another panel. */
async function drag(page: Page, from: string, to: string): Promise<void> {
  const [bar, target] = await Promise.all([page.locator(`[data-panel=${from}] .panel-head h2`).boundingBox(), page.locator(`[data-panel=${to}]`).boundingBox()]);
  await page.mouse.move(bar!.x + 5, bar!.y + 5);
  await page.mouse.down();
  await page.mouse.move(target!.x + target!.width / 2, target!.y + target!.height / 2, { steps: 5 });
}

describe('the order of panels', () => {
  it('changes by dragging a title bar, with the place to drop it shown', async () => {
    const { page, context } = await visit({ hash: kHash });
    await drag(page, 'images', 'map');
    expect(await page.locator('.drop-after').getAttribute('class')).toContain('slot-map');
    await page.mouse.up();
    expect(await kindsOf(page, '.panels-main')).toEqual(['plot', 'map', 'images']);
    expect(await page.locator('.drop-after, .drop-before, .dragged').count()).toBe(0);
    await expect.poll(() => new URL(page.url()).hash).toMatch(/p=plot[^;]*;map[^;]*;images/);
    await drag(page, 'similar', 'inspector');
    expect(await page.locator('.drop-before').getAttribute('class')).toContain('slot-inspector');
    await page.mouse.up();
    expect(await kindsOf(page, '.panels-side')).toEqual(['similar', 'inspector']);
    await page.waitForTimeout(300);
    const other = await context.newPage();
    await other.goto(page.url());
    await other.locator('[data-panel=images]').waitFor();
    expect(await kindsOf(other, '.panels-main')).toEqual(['plot', 'map', 'images']);
  });

  it('stays where Escape is pressed, or where a panel is dropped beside the others', async () => {
    const { page } = await visit({ hash: kHash });
    await drag(page, 'images', 'map');
    await page.keyboard.press('Escape');
    expect(await page.locator('.drop-after, .dragged').count()).toBe(0);
    await page.mouse.up();
    await drag(page, 'images', 'inspector');
    expect(await page.locator('.dragged').count()).toBe(1);
    expect(await page.locator('.drop-after, .drop-before').count()).toBe(0);
    await page.mouse.up();
    expect(await kindsOf(page, '.panels-main')).toEqual(['images', 'plot', 'map']);
  });

  it('changes by keys on a title bar, which is told and keeps the focus', async () => {
    const { page } = await visit({ hash: kHash });
    const bar = page.locator('[data-panel=images] .panel-head');
    await bar.focus();
    await page.keyboard.press('Alt+Shift+ArrowRight');
    await page.keyboard.press('Alt+Shift+ArrowDown');
    expect(await kindsOf(page, '.panels-main')).toEqual(['plot', 'map', 'images']);
    expect(await page.locator('.notice[aria-live]').textContent()).toBe('Images is now 3 of 3.');
    expect(await bar.evaluate((element) => document.activeElement === element)).toBe(true);
    await page.keyboard.press('Alt+Shift+ArrowRight');
    await page.keyboard.press('Alt+Shift+ArrowLeft');
    expect(await kindsOf(page, '.panels-main')).toEqual(['plot', 'images', 'map']);
  });

  it('changes by a finger', async () => {
    const { page } = await visit({ hash: kHash });
    await page.evaluate(() => {
      const bar = document.querySelector<HTMLElement>('[data-panel=images] .panel-head')!;
      const target = document.querySelector('[data-panel=map]')!.getBoundingClientRect();
      bar.setPointerCapture = () => {};
      const send = (type: string, x: number, y: number) => bar.dispatchEvent(new PointerEvent(type, { pointerId: 9, pointerType: 'touch', bubbles: true, button: 0, clientX: x, clientY: y }));
      const box = bar.getBoundingClientRect();
      send('pointerdown', box.x + 60, box.y + 5);
      send('pointermove', target.x + 50, target.y + 50);
      send('pointerup', target.x + 50, target.y + 50);
    });
    expect(await kindsOf(page, '.panels-main')).toEqual(['plot', 'map', 'images']);
  });
});

describe('heights', () => {
  it('of panels change by dragging their lower edge and by keys, and ask nothing', async () => {
    const { page, mock, context } = await visit({ hash: kHash });
    await page.locator('.thumb canvas').first().waitFor();
    const panel = page.locator('[data-panel=images]');
    const handle = page.getByRole('separator', { name: 'Height of Images' });
    const height = async () => Math.round((await panel.boundingBox())!.height);
    await page.waitForTimeout(1500);
    mock.state.requests.length = 0;
    const before = await height();
    const box = (await handle.boundingBox())!;
    await page.mouse.move(box.x + 80, box.y + 3);
    await page.mouse.down();
    await page.mouse.move(box.x + 80, box.y + 63, { steps: 4 });
    await page.mouse.up();
    expect(await height()).toBe(before + 60);
    await handle.focus();
    await page.keyboard.press('ArrowUp');
    await page.keyboard.press('Shift+ArrowDown');
    expect(await height()).toBe(before + 150);
    expect(Number(await handle.getAttribute('aria-valuenow'))).toBe(before + 150);
    expect(mock.state.requests.filter((request) => !/^\/api\/(series|predict)/.test(request))).toEqual([]);
    await expect.poll(() => new URL(page.url()).hash).toContain(`height.${before + 150}`);
    const other = await context.newPage();
    await other.goto(page.url());
    await expect.poll(async () => Math.round((await other.locator('[data-panel=images]').boundingBox())?.height ?? 0)).toBe(before + 150);
    await page.keyboard.press('Home');
    await expect.poll(height).toBeLessThan(before + 150);
    await expect.poll(() => new URL(page.url()).hash).not.toContain('height');
  });

  it('of the timeline is in the address', async () => {
    const { page, context } = await visit({ hash: kHash });
    const splitter = page.getByRole('separator', { name: 'Height of the timeline' });
    const before = Number(await splitter.getAttribute('aria-valuenow'));
    await splitter.focus();
    await page.keyboard.press('Shift+ArrowUp');
    await expect.poll(() => new URL(page.url()).hash).toContain(`&h=${before - 100}&`);
    const other = await context.newPage();
    await other.goto(page.url());
    await expect.poll(() => other.getByRole('separator', { name: 'Height of the timeline' }).getAttribute('aria-valuenow')).toBe(String(before - 100));
  });
});
