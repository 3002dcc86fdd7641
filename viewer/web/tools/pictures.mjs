// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of docs/viewer.md: node tools/pictures.mjs URL FOLDER [CHROMIUM]. URL is what
// `engram view` prints of a kitchen that a night consolidated, such as that of `make demo`.
import { mkdirSync } from 'node:fs';
import { chromium } from 'playwright-core';

const [url, folder, executablePath = '/usr/bin/chromium'] = process.argv.slice(2);
if (!url || !folder) {
  console.error('usage: node tools/pictures.mjs URL FOLDER [CHROMIUM]');
  process.exit(2);
}
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader'] });

/** Opens the memory, does what `steps` do, waits until all panels are quiet, and takes a picture. */
async function picture(name, colorScheme, viewport, steps) {
  const context = await browser.newContext({ viewport, colorScheme, reducedMotion: 'reduce' });
  const page = await context.newPage();
  page.on('pageerror', (error) => console.error(`${name}: ${error.message}`));
  await page.goto(url);
  await page.getByRole('slider', { name: 'Cursor in time' }).waitFor();
  await steps(page);
  await page.waitForLoadState('networkidle');
  await page.waitForTimeout(1500);
  await page.screenshot({ path: `${folder}/${name}.png` });
  await context.close();
}

async function choose(page, name) {
  await page.keyboard.press('/');
  await page.getByLabel('Name of an entity').fill(name);
  await page.keyboard.press('Enter');
}

/** Puts the cursor near the middle of the memory and looks at the seconds around it. */
async function middle(page) {
  const bar = await page.getByRole('slider', { name: 'Cursor in time' }).boundingBox();
  await page.mouse.click(bar.x + 0.45 * bar.width, bar.y + bar.height / 2);
  for (let i = 0; i < 3; ++i) await page.keyboard.press('+');
  await choose(page, 'stereo');
}

const wide = { width: 1440, height: 900 };
const tall = { width: 800, height: 1200 };
for (const [size, viewport] of [['', wide], ['-tall', tall]])
  for (const scheme of ['light', 'dark']) {
    await picture(`past-${scheme}${size}`, scheme, viewport, middle);
    await picture(`scene-${scheme}${size}`, scheme, viewport, async (page) => {
      await page.goto(`${url}#1&h=150&p=scene~~~height.560;inspector`);
      await middle(page);
      await page.locator('.scene canvas').waitFor();
      await page.waitForTimeout(4000);
      // From its side, so that one sees what it sees.
      const scene = await page.locator('.scene').boundingBox();
      const [x, y] = [scene.x + scene.width * 0.6, scene.y + scene.height * 0.7];
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 70, y + 22, { steps: 8 });
      await page.mouse.up();
      await page.mouse.wheel(0, -350);
    });
    await picture(`future-${scheme}${size}`, scheme, viewport, async (page) => {
      await choose(page, 'stereo');
      await page.keyboard.press('f');
      for (let i = 0; i < 3; ++i) await page.keyboard.press('+');
      // The first prediction learns.
      await page.waitForTimeout(15000);
    });
  }
await browser.close();
