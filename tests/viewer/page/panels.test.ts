// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { choose, coloursOf, cursorOf, goTo, json, kStart, useBrowser, visit } from './browser';

useBrowser();

describe('the future', () => {
  it('is predicted behind the last snapshot, with engine, expected error and bound', async () => {
    const { page } = await visit();
    await page.keyboard.press('f');
    const facts = page.getByLabel(/^Inspector/).locator('.facts').first();
    await expect.poll(() => facts.textContent()).toMatch(/predicted deep/);
    expect(await facts.textContent()).toMatch(/Horizon\+4\d\d msExpected error0\.\d+Bound \(90 %\)0\.\d+/);
    const images = page.locator('[data-panel=images]');
    await images.getByText('Predicted', { exact: true }).waitFor();
    await images.getByText('Last seen').waitFor();
    await expect.poll(() => images.locator('figcaption').last().textContent()).toMatch(/expected error 0\.051 · bound 0\.097/);
    expect(await page.locator('.clock').textContent()).toContain('+400 ms');
  });

  it('is reached by dragging the cursor on the axis', async () => {
    const { page } = await visit();
    const box = (await page.getByTestId('surface').boundingBox())!;
    await page.mouse.move(box.x + box.width * 0.5, box.y + 8);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width - 12, box.y + 8, { steps: 6 });
    await page.mouse.up();
    await expect.poll(() => page.locator('.clock').getAttribute('class')).toContain('future');
    await expect.poll(() => page.getByLabel(/^Inspector/).textContent()).toContain('predicted');
  });

  it('is drawn dashed in plots, asked for coarsely first', async () => {
    const { page, mock } = await visit();
    await page.locator('[data-panel=plot]').first().getByText(/predicted by/).waitFor();
    const horizons = mock.state.requests.filter((request) => request.startsWith('/api/predict')).map((request) => new URLSearchParams(request.split('?')[1]).get('horizon')!.split(',').length);
    expect(horizons.slice(0, 1)).toEqual([3]);
    expect(horizons).toContain(16);
  });

  it('is predicted from a past moment beside what came', async () => {
    const { page } = await visit();
    await goTo(page, '07:12:08.25');
    const images = page.locator('[data-panel=images]');
    await images.getByLabel('predict ahead').selectOption({ label: '+400 ms' });
    for (const title of ['From here', 'Predicted', 'What came']) await images.getByText(title, { exact: true }).waitFor();
    expect(await images.locator('canvas').count()).toBe(3);
    const plot = page.locator('[data-panel=plot]').first();
    await plot.getByRole('button', { name: 'Predict from the cursor' }).click();
    await plot.getByText(/predicted by related/).waitFor();
  });
});

describe('images', () => {
  it('give back their pixels when others take their place', async () => {
    const { page } = await visit();
    await page.evaluate(() => {
      const counts = { open: 0 };
      const make = window.createImageBitmap.bind(window) as (blob: Blob) => Promise<ImageBitmap>;
      const close = ImageBitmap.prototype.close;
      window.createImageBitmap = (async (blob: Blob) => { const made = await make(blob); counts.open += 1; return made; }) as typeof window.createImageBitmap;
      ImageBitmap.prototype.close = function (this: ImageBitmap) { counts.open -= 1; close.call(this); };
      Object.assign(window, { counts });
    });
    await page.getByRole('button', { name: 'Close Similar moments' }).click();
    await choose(page, 'stereo');
    for (let i = 0; i < 12; ++i) {
      await goTo(page, `07:12:${10 + i}.25`);
      await page.waitForTimeout(120);
    }
    await page.waitForTimeout(500);
    expect(await page.evaluate(() => (window as unknown as { counts: { open: number } }).counts.open)).toBeLessThanOrEqual(3);
    expect(await page.locator('[data-panel=images] canvas').count()).toBe(3);
  });

  it('of what came are of that time alone', async () => {
    const { page } = await visit();
    const images = page.locator('[data-panel=images]');
    await images.getByLabel('predict ahead').selectOption({ label: '+400 ms' });
    await images.getByText('Nothing was recorded at that time.').waitFor();
  });

  it('are shown recorded, reconstructed and as a map of errors, with what they cost', async () => {
    const { page } = await visit();
    await goTo(page, '07:12:08.25');
    const images = page.locator('[data-panel=images]');
    await expect.poll(() => images.locator('canvas').count()).toBe(3);
    await expect.poll(() => images.textContent()).toMatch(/Recorded19\.8 kB.*Reconstructed\d\d\.\d dB · 412 B.*Error map\d\d\.\d dB · gain 8/);
    const colours = await coloursOf(page, '[data-panel=images] canvas');
    expect(colours.length).toBeGreaterThan(200);
  });

  it('that are missing say why, and are not asked for', async () => {
    const { page, mock } = await visit();
    const images = page.locator('[data-panel=images]');
    await images.getByText(/No latents yet/).waitFor();
    expect(mock.state.requests.some((request) => request.includes('form=latent'))).toBe(false);
    await goTo(page, '07:05:00');
    await images.getByText(/dropped after a night/).waitFor();
  });

  it('blink, slide and change the eye', async () => {
    const { page } = await visit();
    await goTo(page, '07:12:08.25');
    const images = page.locator('[data-panel=images]');
    await images.getByRole('button', { name: 'Blink' }).click();
    const swap = images.locator('.swap');
    await swap.waitFor();
    const first = await swap.textContent();
    await expect.poll(() => swap.textContent()).not.toBe(first);
    await images.getByRole('button', { name: 'Slide' }).click();
    await images.getByRole('slider', { name: 'Line between Recorded and Reconstructed' }).fill('25');
    expect(await images.locator('.compare-over').evaluate((over) => (over as HTMLElement).style.clipPath)).toBe('inset(0px 0px 0px 25%)');
    await images.getByRole('button', { name: 'right', exact: true }).click();
    await expect.poll(() => images.getByRole('button', { name: 'right', exact: true }).getAttribute('aria-pressed')).toBe('true');
  });

  it('stand still for who wants less motion', async () => {
    const { page } = await visit({ still: true });
    await goTo(page, '07:12:08.25');
    const images = page.locator('[data-panel=images]');
    await images.getByRole('button', { name: 'Blink' }).click();
    const first = await images.locator('.swap').textContent();
    await page.waitForTimeout(1400);
    expect(await images.locator('.swap').textContent()).toBe(first);
    await images.locator('.swap').click();
    expect(await images.locator('.swap').textContent()).not.toBe(first);
  });
});

describe('plots', () => {
  it('find a series among many and add it', async () => {
    const { page } = await visit();
    const plot = page.locator('[data-panel=plot]').first();
    await plot.getByRole('button', { name: 'Choose series' }).click();
    await plot.getByLabel('Search series').fill('hand_right_thumb_1 rad/s');
    await plot.getByRole('checkbox').first().check();
    await page.keyboard.press('Escape');
    expect(await plot.getByLabel('Search series').count()).toBe(0);
    await plot.getByRole('button', { name: /hand_right_thumb_1 velocity/ }).waitFor();
  });

  it('get at most two points per pixel', async () => {
    const { page, mock } = await visit();
    await page.locator('.plot-host canvas').first().waitFor();
    const width = (await page.locator('.plot-host').first().boundingBox())!.width;
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/series')).map((request) => Number(new URLSearchParams(request.split('?')[1]).get('pixels')));
    // Twice as wide as the screen, so one bin (two points) for a pixel of it.
    for (const pixels of asked) expect(pixels).toBeLessThanOrEqual(2 * 1440);
    expect(Math.min(...asked)).toBeLessThanOrEqual(2 * width);
  });

  it('fit their axis to what is seen, and to what comes later', async () => {
    // A ramp from 0 to 1 over the whole memory, of which the gateway first reads nothing but zeros.
    let isRead = false;
    const { page } = await visit({ intercept: (url) => {
      if (url.pathname !== '/api/series') return null;
      const [from, to, pixels] = ['from', 'to', 'pixels'].map((name) => Number(url.searchParams.get(name))) as [number, number, number];
      const paths = url.searchParams.getAll('path').length;
      const values = Float32Array.from({ length: pixels }, (_, i) => (isRead ? (from + ((i + 0.5) / pixels) * (to - from) - Number(kStart)) / 730e9 : 0));
      const all = new Float32Array(3 * pixels * paths);
      for (let i = 0; i < 3 * paths; ++i) all.set(values, i * pixels);
      return { status: 200, type: 'application/octet-stream', body: new Uint8Array(all.buffer), headers: { 'X-Engram-Read': isRead ? '10' : '5', 'X-Engram-Total': '10' } };
    } });
    await page.locator('.plot-host canvas').first().waitFor();
    const axis = async (): Promise<number[]> => {
      const waiting = page.waitForEvent('download');
      await page.getByRole('button', { name: 'Save this plot as SVG' }).first().click();
      const svg = readFileSync(await (await waiting).path(), 'utf8');
      return [...svg.matchAll(/<text[^>]*text-anchor="end"[^>]*>([^<]*)</g)].map((found) => Number(found[1]!.replace('\u2212', '-').replace(/[\u2009\u00a0 ]/g, '')));
    };
    const highest = async () => Math.max(...(await axis()));
    await expect.poll(highest).toBeLessThan(0.1);
    isRead = true;
    for (const key of ['+', '-']) await page.keyboard.press(key);
    await expect.poll(highest).toBeGreaterThan(0.5);
    const all = await axis();
    await goTo(page, '07:06:00');
    for (let i = 0; i < 12; ++i) await page.keyboard.press('+');
    await expect.poll(async () => { const seen = await axis(); return Math.max(...seen) - Math.min(...seen); }).toBeLessThan(0.2 * (Math.max(...all) - Math.min(...all)));
  });

  it('hide a series and show numbers as a table', async () => {
    const { page } = await visit();
    const plot = page.locator('[data-panel=plot]').first();
    const key = plot.getByRole('button', { name: /torso_lift/ });
    await key.click();
    expect(await key.getAttribute('aria-pressed')).toBe('false');
    await plot.getByRole('button', { name: 'Show as a table' }).click();
    await plot.getByRole('columnheader', { name: 'neck_yaw' }).waitFor();
    expect(await plot.locator('tbody tr').count()).toBe(100);
    await plot.locator('tbody th button').nth(30).click();
    expect(Number((await cursorOf(page)) - kStart) / 1e9).toBeLessThan(700);
  });

  it('zoom together with the timeline', async () => {
    const { page } = await visit();
    const over = page.locator('.u-over').first();
    await over.waitFor();
    await over.hover();
    const before = await page.locator('.timeline-corner').textContent();
    await page.mouse.wheel(0, -400);
    await expect.poll(() => page.locator('.timeline-corner').textContent()).not.toBe(before);
  });
});

describe('the inspector', () => {
  it('shows the tree of a value with types and units, and copies path, query and Python', async () => {
    const { page } = await visit();
    await choose(page, 'battery');
    const inspector = page.getByLabel(/^Inspector/);
    await expect.poll(() => inspector.textContent()).toMatch(/voltage4\d\.\d+ V/);
    const copied = () => page.evaluate(() => navigator.clipboard.readText());
    await inspector.getByRole('treeitem', { name: /voltage/ }).hover();
    await inspector.getByRole('button', { name: 'Copy the path voltage' }).click();
    await expect.poll(copied).toBe('voltage');
    await inspector.getByRole('button', { name: 'Copy a line of Python for voltage' }).click();
    await expect.poll(copied).toMatch(/^engram\.open\("\/data\/kitchen\.engram"\)\["RobotState\/Proprioception\/robot\/battery"\]\.at\(\d{19}\)\.value\["voltage"\]$/);
    await inspector.getByRole('button', { name: 'Copy the query of this snapshot' }).click();
    await expect.poll(copied).toMatch(/^RobotState\/Proprioception\/robot\/battery @ 2026-01-01 07:22:59\.\d+$/);
    await inspector.getByRole('treeitem', { name: /voltage/ }).focus();
    await inspector.getByRole('button', { name: 'Plot voltage' }).click();
    await page.locator('[data-panel=plot]').filter({ hasText: 'battery' }).waitFor();
  });

  it('follows links both ways', async () => {
    const { page } = await visit();
    await goTo(page, '07:12:08.25');
    const inspector = page.getByLabel(/^Inspector/);
    await inspector.getByRole('button', { name: /^Linked from Objects\/Instances\/kitchen\/cereal_box_1/ }).click();
    await expect.poll(() => inspector.locator('.entity-path').textContent()).toBe('Objects/Instances/kitchen/cereal_box_1');
    await inspector.getByRole('button', { name: /^Links to Vision\/RGB\/head\/stereo/ }).first().click();
    await expect.poll(() => inspector.locator('.entity-path').textContent()).toBe('Vision/RGB/head/stereo');
  });
});

describe('values in the inspector', () => {
  it('keeps open what was opened in the next snapshot', async () => {
    const { page } = await visit();
    await goTo(page, '07:12:08.25');
    await choose(page, 'salt');
    const node = () => page.getByLabel(/^Inspector/).getByRole('treeitem', { name: /orientation/ }).first();
    await node().focus();
    const open = await node().getAttribute('aria-expanded');
    await node().press(open === 'true' ? 'ArrowLeft' : 'ArrowRight');
    const before = await cursorOf(page);
    await page.getByRole('button', { name: 'Next snapshot of the chosen entity' }).click();
    await expect.poll(() => cursorOf(page)).not.toBe(before);
    await page.waitForTimeout(300);
    expect(await node().getAttribute('aria-expanded')).toBe(open === 'true' ? 'false' : 'true');
  });

  it('shows a value that is a number itself, and the first of very many', async () => {
    let data: unknown = 21.5;
    const moment = () => json({ id: 'A/B/C/D/5', time: '1767250800000000000', source: 'recorded', instances: [{ index: 0, data }], previous: null, next: null });
    const { page } = await visit({ expected: /404/, intercept: (url) => (url.pathname === '/api/moment' ? moment() : null) });
    const inspector = page.getByLabel(/^Inspector/);
    await expect.poll(() => inspector.getByRole('treeitem').allTextContents()).toEqual([expect.stringMatching(/value.*21\.5/)]);
    data = Object.fromEntries(Array.from({ length: 20_000 }, (_, i) => [`<img src=x onerror=alert(${i})>`, i]));
    await choose(page, 'salt');
    await inspector.getByText('and 19488 more').waitFor();
    expect(await page.locator('img').count()).toBe(0);
  });

  it('takes its lines with it, and shows no links of another snapshot', async () => {
    const { page, mock } = await visit();
    const chips = page.getByLabel(/^Inspector/).locator('.chip');
    await choose(page, 'stereo');
    await expect.poll(() => chips.count()).toBeGreaterThan(0);
    mock.state.delayMs = 400;
    await choose(page, 'battery');
    await page.getByLabel(/^Inspector/).getByRole('treeitem', { name: /voltage/ }).waitFor();
    expect(await chips.count()).toBe(0);
    mock.state.delayMs = 0;
    await choose(page, 'stereo');
    const ink = () => page.locator('.overlay-canvas').evaluate((element) => {
      const canvas = element as HTMLCanvasElement;
      const { data } = canvas.getContext('2d')!.getImageData(0, 30, canvas.width, canvas.height - 30);
      for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 90 && data[i]! < 60 && data[i + 1]! < 60 && data[i + 2]! < 60) return true;
      return false;
    });
    await expect.poll(ink).toBe(true);
    await page.getByRole('button', { name: 'Close Inspector' }).click();
    await expect.poll(ink).toBe(false);
  });
});

describe('similar moments', () => {
  it('are thumbnails and marks, and a click goes there', async () => {
    const { page } = await visit();
    const panel = page.locator('[data-panel=similar]');
    await expect.poll(() => panel.locator('.thumb canvas').count()).toBe(12);
    await expect.poll(() => coloursOf(page, '.overlay-canvas')).toEqual(expect.arrayContaining(['179,65,11']));
    const second = panel.locator('.thumb').nth(1);
    const label = (await second.getAttribute('title'))!;
    await second.click();
    const time = /07:\d\d:\d\d\.\d+/.exec(label)![0];
    await expect.poll(() => page.locator('.clock').textContent()).toContain(time.slice(0, 12));
  });
});

describe('other panels', () => {
  it('tell what each entity takes', async () => {
    const { page } = await visit();
    await page.keyboard.press('n');
    const panel = page.locator('[data-panel=nights]');
    await expect.poll(() => panel.locator('tbody tr').count()).toBe(32);
    expect(await panel.textContent()).toMatch(/plain, kept in/);
  });

  it('ask in the language of queries', async () => {
    const { page } = await visit({ expected: /404/ });
    await page.getByRole('button', { name: 'Panel', exact: true }).click();
    await page.getByRole('button', { name: 'Query', exact: true }).click();
    const panel = page.locator('[data-panel=query]');
    await panel.getByLabel('Query', { exact: true }).fill('Speech @ latest');
    await panel.getByRole('button', { name: 'Ask' }).click();
    await expect.poll(() => panel.locator('tbody tr').count()).toBe(2);
    await panel.getByLabel('Query', { exact: true }).fill('Nothing @ latest');
    await page.keyboard.press('Enter');
    await panel.getByRole('alert').getByText(/no entity matches/).waitFor();
  });

  it('show what has a place in three dimensions, and as a table', async () => {
    const { page } = await visit();
    expect(await page.locator('script[src*=Scene]').count()).toBe(0);
    await page.keyboard.press('3');
    const panel = page.locator('[data-panel=scene]');
    await panel.locator('canvas').waitFor();
    await expect.poll(() => panel.locator('.scene-label').count()).toBeGreaterThan(2);
    await panel.getByRole('button', { name: 'Show places as a table' }).click();
    await panel.getByRole('button', { name: 'Objects/Instances/kitchen/milk_1' }).waitFor();
  });

  it('move, by buttons and by dragging, and close', async () => {
    const { page } = await visit();
    const kinds = () => page.locator('.panels-main [data-panel]').evaluateAll((all) => all.map((one) => one.getAttribute('data-panel')));
    await expect.poll(kinds).toEqual(['images', 'plot', 'plot']);
    await page.getByRole('button', { name: 'Move Images back' }).click();
    expect(await kinds()).toEqual(['plot', 'images', 'plot']);
    await page.locator('[data-panel=images] .panel-head h2').dragTo(page.locator('[data-panel=plot]').first());
    expect(await kinds()).toEqual(['images', 'plot', 'plot']);
    await page.getByRole('button', { name: 'Close Images' }).click();
    expect(await kinds()).toEqual(['plot', 'plot']);
  });
});
