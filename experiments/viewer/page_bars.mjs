// SPDX-License-Identifier: Apache-2.0
// Measures the page in a browser, as a person has it: page_bars.mjs WEB TASK ARGUMENTS..., where WEB
// is where the build made the page (its Playwright is used). Prints JSON. viewer_bars.py runs it.
//
//   open ENGRAM STORE ROUNDS    from the command to a timeline with counts
//   images URL ORDER STEPS      from a key to all forms of the next image, or scattered: the tenth
//   scrub URL SECONDS           frames while the cursor moves over 4 images and 8 plots
//   predict URL STEPS           from a key to the predicted value
//   live URL SECONDS            how old what a following page shows is, and its heap
//   names URL SECONDS           frames while all names of a large memory scroll by
import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';
import { existsSync } from 'node:fs';
import { createInterface } from 'node:readline';

const [web, task, ...rest] = process.argv.slice(2);
const { chromium } = createRequire(`${web}/package.json`)('playwright-core');
const executablePath = process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader'] });

async function open(url) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  // When a picture was last drawn into a tile: what a person sees of it comes with the next frame.
  await page.addInitScript(() => {
    globalThis.drawn = { count: 0, at: 0 };
    const draw = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function (...words) {
      if (this.canvas.closest?.('.tile')) globalThis.drawn = { count: globalThis.drawn.count + 1, at: performance.now() };
      return draw.apply(this, words);
    };
  });
  await page.goto(url);
  return page;
}

async function choose(page, name) {
  await page.keyboard.press('/');
  await page.getByLabel('Name of an entity').fill(name);
  await page.keyboard.press('Enter');
}

/** Milliseconds between frames while `move` is called before each, for some seconds. */
const framesWhile = (page, seconds, move, argument) => page.evaluate(async ([length, code, given]) => {
  const step = new Function('i', 'given', code);
  const times = [];
  const end = performance.now() + length * 1000;
  for (let i = 0; performance.now() < end; ++i) {
    step(i, given);
    times.push(await new Promise((done) => requestAnimationFrame(done)));
  }
  return times.slice(1).map((time, i) => time - times[i]);
}, [seconds, move, argument]);

/** From a key to what `changed` waits for, again and again. */
async function stepsUntil(page, key, steps, selector, pause) {
  const times = [];
  for (let i = 0; i < steps; ++i) {
    times.push(await page.evaluate(async ([name, watched, still]) => {
      const text = () => document.querySelector(watched)?.textContent ?? '';
      const before = watched === '' ? globalThis.drawn.count : text();
      const begin = performance.now();
      document.body.dispatchEvent(new KeyboardEvent('keydown', { key: name.replace('Shift+', ''), shiftKey: name.startsWith('Shift+'), bubbles: true }));
      for (;;) {
        if (watched === '' ? globalThis.drawn.count > before : text() !== before) break;
        if (performance.now() - begin > 20_000) return NaN;
        await new Promise((done) => setTimeout(done, 0));
      }
      const took = (watched === '' ? globalThis.drawn.at : performance.now()) - begin;
      await new Promise((done) => setTimeout(done, still));
      return took;
    }, [key, selector, pause]));
  }
  return times;
}

const tasks = {
  async open(engram, store, rounds) {
    const times = [];
    for (let i = 0; i < Number(rounds); ++i) {
      const begin = performance.now();
      const program = spawn(engram, ['view', store, '--json'], { stdio: ['ignore', 'pipe', 'inherit'] });
      const { value } = await createInterface(program.stdout)[Symbol.asyncIterator]().next();
      const answered = performance.now() - begin;
      const page = await open(JSON.parse(value).url);
      await page.getByRole('slider', { name: 'Cursor in time' }).waitFor();
      // Counts are drawn in the colours of their forms; before, a lane has none of them.
      await page.waitForFunction(() => [...document.querySelectorAll('canvas')].some((canvas) => {
        if (canvas.width < 300) return false;
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        for (let at = 0; at < data.length; at += 4) if (data[at] < 40 && data[at + 1] > 90 && data[at + 1] < 140 && data[at + 2] > 150) return true;
        return false;
      }), null, { polling: 'raf' });
      times.push({ command: answered, usable: performance.now() - begin });
      await page.context().close();
      program.kill('SIGINT');
      await new Promise((done) => program.once('exit', done));
    }
    return times;
  },
  async images(url, order, steps) {
    const page = await open(url);
    await choose(page, 'stereo');
    await page.locator('.tile canvas').first().waitFor();
    await page.keyboard.press('Home');
    await page.waitForTimeout(3000);
    return stepsUntil(page, order === 'scattered' ? 'Shift+ArrowRight' : 'ArrowRight', Number(steps), '', 150);
  },
  async predict(url, steps) {
    const page = await open(url);
    await choose(page, 'joints');
    await page.keyboard.press('f');
    await page.getByLabel(/^Inspector/).locator('.facts').first().getByText('predicted').waitFor();
    await page.waitForTimeout(3000);
    return stepsUntil(page, 'ArrowRight', Number(steps), '[data-panel=inspector] .facts', 200);
  },
  async scrub(url, seconds) {
    const joints = 'RobotState/Proprioception/robot/joints';
    const panels_ = [
      ...['Vision/RGB/head/stereo', 'Vision/Depth/head/left'].flatMap((id) => [0, 1].map(() => `images~${id}`)),
      ...[0, 1, 2, 3, 4, 0, 1, 2].map((i) => `plot~${joints}~positions%5B${i}%5D`),
    ];
    const page = await open(`${url}#1&s=${joints}&p=${panels_.join(';')}`);
    await page.locator('.tile canvas').first().waitFor();
    await page.waitForTimeout(4000);
    const slider = page.getByRole('slider', { name: 'Cursor in time' });
    const box = await slider.boundingBox();
    const before = await slider.getAttribute('aria-valuenow');
    const panels = await page.locator('[data-panel]').evaluateAll((all) => all.map((one) => one.getAttribute('data-panel')));
    // Dragging moves the cursor on the axis above the lanes; below it, it moves the picture.
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 8);
    await page.mouse.down();
    const frames = await framesWhile(page, Number(seconds), `
      const { x, y, width, height } = given;
      const target = document.elementFromPoint(x + 0.3 * width, y + 8);
      target.dispatchEvent(new PointerEvent('pointermove', { bubbles: true, pointerId: 1, buttons: 1, clientX: x + (0.3 + 0.4 * (i % 600) / 600) * width, clientY: y + 8 }));`, box);
    const moved = await slider.getAttribute('aria-valuenow');
    await page.mouse.up();
    if (moved === before) throw new Error(`The cursor stayed at ${before} % while it was dragged.`);
    return { frames, panels };
  },
  async live(url, seconds) {
    const page = await open(url);
    await page.getByRole('slider', { name: 'Cursor in time' }).waitFor();
    await choose(page, 'joints');
    await page.locator('.tile canvas').first().waitFor();
    await page.waitForTimeout(3000);
    const session = await page.context().newCDPSession(page);
    await session.send('HeapProfiler.enable');
    // Times of commits are those of the clock of this machine. What is drawn is seen with the next frame.
    await page.evaluate(() => {
      const ages = { clock: [], value: [], image: [] };
      globalThis.ages = ages;
      const day = () => document.querySelector('.clock .date').textContent;
      const clock = () => { const at = ['.time', '.nano'].map((name) => document.querySelector(`.clock ${name}`).textContent).join('').replace(/[^\d:.]/g, ''); return Date.parse(`${day()}T${at.slice(0, 12)}Z`); };
      let before = { clock: '', value: '', image: 0 };
      const watch = () => {
        const now = { clock: document.querySelector('.clock').textContent, value: document.querySelector('[data-panel=inspector]')?.textContent ?? '', image: globalThis.drawn.count };
        const age = Date.now() - clock();
        for (const name of Object.keys(ages)) if (now[name] !== before[name] && age < 60_000 && ages[name].length < 20_000) ages[name].push(age);
        before = now;
        requestAnimationFrame(watch);
      };
      watch();
    });
    const heap = [];
    const end = Date.now() + 1000 * Number(seconds);
    while (Date.now() < end) {
      await page.waitForTimeout(Math.min(30_000, (1000 * Number(seconds)) / 12));
      await session.send('HeapProfiler.collectGarbage');
      heap.push((await session.send('Runtime.getHeapUsage')).usedSize / 2 ** 20);
    }
    return { ages: await page.evaluate(() => globalThis.ages), heap_mb: heap };
  },
  async names(url, seconds) {
    const page = await open(url);
    await page.getByRole('treeitem').first().waitFor();
    await page.waitForTimeout(1500);
    return framesWhile(page, Number(seconds), `
      const list = [...document.querySelectorAll('*')].filter((one) => one.scrollHeight > one.clientHeight + 50 && getComputedStyle(one).overflowY !== 'visible')[0];
      if (list) list.scrollTop = (i * 37) % (list.scrollHeight - list.clientHeight);`);
  },
};

try {
  console.log(JSON.stringify(await tasks[task](...rest)));
} finally {
  await browser.close();
}
