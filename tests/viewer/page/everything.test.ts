// SPDX-License-Identifier: Apache-2.0
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { axeSource, choose, cursorOf, goTo, json, kStart, refusal, useBrowser, viewOf, visit } from './browser';

useBrowser();

describe('the address', () => {
  it('opens the same view elsewhere', async () => {
    const { page, mock, context } = await visit();
    await goTo(page, '07:12:08.250000007');
    for (let i = 0; i < 5; ++i) await page.keyboard.press('+');
    await choose(page, 'salt');
    await page.getByRole('button', { name: 'Close Similar moments' }).click();
    await page.keyboard.press('p');
    await page.keyboard.press('l');
    await page.waitForTimeout(300);
    const link = await page.evaluate(() => navigator.clipboard.readText());
    expect(link.startsWith(`${mock.address}#1&`)).toBe(true);
    const [cursor, view] = [await cursorOf(page), await viewOf(page)];
    expect(cursor).toBe(kStart + 728_250_000_007n);
    const other = await context.newPage();
    await other.goto(link);
    await other.getByLabel(/^Inspector/).locator('.entity-path').waitFor();
    expect(await other.getByLabel(/^Inspector/).locator('.entity-path').textContent()).toBe('Objects/Instances/kitchen/salt_1');
    expect(await cursorOf(other)).toBe(cursor);
    expect(await viewOf(other)).toEqual(view);
    expect(await other.locator('[data-panel]').evaluateAll((all) => all.map((one) => one.getAttribute('data-panel')))).toEqual(['images', 'plot', 'plot', 'plot', 'inspector']);
  });

  it('that is broken opens the memory all the same', async () => {
    const { page } = await visit({ hash: '#1&t=zzzzzzzzzzzzzzz&v=%&s=Not/There&p=' , ready: false, expected: /404/ });
    await page.getByRole('slider', { name: 'Cursor in time' }).waitFor();
    await page.getByText('No panel is open').waitFor();
  });
});

describe('several memories', () => {
  it('are shown one at a time, at the same moment, and in the address', async () => {
    const names = { memories: [{ name: 'kitchen', path: '/data/monday/kitchen' }, { name: 'kitchen', path: '/data/tuesday/kitchen' }, { name: 'hall', path: '/data/hall' }] };
    const { page, mock } = await visit({ intercept: (url) => (url.pathname === '/api/memories' ? json(names) : null) });
    const choice = page.getByRole('combobox', { name: 'Memory' });
    expect(await choice.locator('option').allTextContents()).toEqual(['/data/monday/kitchen', '/data/tuesday/kitchen', 'hall']);
    await goTo(page, '07:06:00');
    await choose(page, 'salt');
    mock.state.requests.length = 0;
    await choice.selectOption({ label: 'hall' });
    await expect.poll(() => new URL(page.url()).hash).toMatch(/^#1&m=2&/);
    await page.getByLabel(/^Inspector/).locator('.entity-path').waitFor();
    expect(await choice.inputValue()).toBe('2');
    expect(await cursorOf(page)).toBe(kStart + 360_000_000_000n);
    expect(await page.getByLabel(/^Inspector/).locator('.entity-path').textContent()).toBe('Objects/Instances/kitchen/salt_1');
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/') && !/^\/api\/(live|memories)/.test(request)).slice(-5);
    expect(asked.length).toBe(5);
    for (const request of asked) expect(new URLSearchParams(request.split('?')[1]).get('memory')).toBe('2');
  });
});

describe('pictures of panels', () => {
  it.each([['Save these images as PNG', 'stereo.png'], ['Save this plot as PNG', 'plot.png'], ['Save the timeline as PNG', 'timeline.png']])('%s', async (button, name) => {
    const { page } = await visit();
    await page.locator('.plot-host canvas').first().waitFor();
    await page.locator('[data-panel=images] canvas').first().waitFor();
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: button }).first().click();
    const file = await waiting;
    expect(file.suggestedFilename()).toBe(name);
    expect([...readFileSync(await file.path()).subarray(1, 4)]).toEqual([...Buffer.from('PNG')]);
  });

  it.each([
    ['Save this plot as SVG', 'plot.svg', /RobotState\/Proprioception\/robot\/joints/, 8],
    ['Save the timeline as SVG', 'timeline.svg', /head \/ stereo/, 30],
    ['Save the trace as SVG', 'trace.svg', /robot\/joints/, 6],
  ])('are vectors, too: %s', async (button, name, text, shapes) => {
    const { page, context } = await visit();
    await page.locator('.plot-host canvas').first().waitFor();
    await page.locator('details.trace summary').click();
    await page.locator('.trace-node').nth(3).waitFor();
    await expect.poll(() => page.getByText('following links').count()).toBe(0);
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: button }).first().click();
    const file = await waiting;
    expect(file.suggestedFilename()).toBe(name);
    const svg = readFileSync(await file.path(), 'utf8');
    expect(svg).not.toMatch(/<image|data:|var\(--|class=/);
    // A browser takes it as it is, with its texts.
    const other = await context.newPage();
    const seen = await other.evaluate((source) => {
      const drawn = new DOMParser().parseFromString(source, 'image/svg+xml');
      return { error: drawn.querySelector('parsererror')?.textContent ?? '', shapes: drawn.querySelectorAll('path, rect').length, texts: [...drawn.querySelectorAll('text')].map((one) => one.textContent ?? '') };
    }, svg);
    expect(seen.error).toBe('');
    expect(seen.shapes).toBeGreaterThanOrEqual(shapes);
    expect(seen.texts.some((one) => text.test(one))).toBe(true);
    await other.close();
  });
});

describe('the keyboard', () => {
  it('does everything: play, step, choose, zoom, search, help', async () => {
    const { page } = await visit();
    await page.keyboard.press('Home');
    const first = await cursorOf(page);
    await choose(page, 'joints');
    await page.keyboard.press('ArrowRight');
    await expect.poll(() => cursorOf(page)).not.toBe(first);
    const one = await cursorOf(page);
    expect(Number(one - first) / 1e6).toBeLessThan(40);
    await page.keyboard.press('Shift+ArrowRight');
    await expect.poll(() => cursorOf(page)).not.toBe(one);
    expect(Number((await cursorOf(page)) - one) / 1e6).toBeGreaterThan(150);
    await page.keyboard.press('Shift+ArrowLeft');
    await expect.poll(() => cursorOf(page)).toBe(one);
    await page.keyboard.press('ArrowDown');
    await expect.poll(() => page.locator('.entity-path').textContent()).toBe('RobotState/Proprioception/robot/battery');
    await page.keyboard.press(' ');
    await page.getByRole('button', { name: 'Pause' }).waitFor();
    await page.waitForTimeout(600);
    await page.keyboard.press(' ');
    const played = Number((await cursorOf(page)) - one) / 1e9;
    expect(played).toBeGreaterThan(0.2);
    expect(played).toBeLessThan(5);
    const before = await viewOf(page);
    await page.keyboard.press('+');
    expect((await viewOf(page)).length).toBeLessThan(before.length);
    await page.keyboard.press('0');
    expect((await viewOf(page)).length).toBe(before.length);
    await page.keyboard.press('?');
    await page.getByRole('dialog', { name: 'Keys and gestures' }).waitFor();
    await page.keyboard.press('Escape');
    await expect.poll(() => page.getByRole('dialog').count()).toBe(0);
    await page.keyboard.press('/');
    await page.keyboard.type('salt');
    await page.keyboard.press('Escape');
    await expect.poll(() => page.getByRole('dialog').count()).toBe(0);
    await page.keyboard.press('[');
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForTimeout(200);
    await page.keyboard.press(']');
    await page.getByText(/selected$/).waitFor();
  });

  it('walks through lanes and values', async () => {
    const { page } = await visit();
    await page.getByRole('treeitem', { name: /^Vision/ }).focus();
    await page.keyboard.press('Enter');
    await expect.poll(() => page.getByRole('treeitem', { name: /^Vision/ }).getAttribute('aria-expanded')).toBe('false');
    await page.keyboard.press('ArrowDown');
    await expect.poll(() => page.evaluate(() => document.activeElement?.id)).toBe('row-RobotState');
    const node = page.getByLabel(/^Inspector/).getByRole('treeitem', { name: /pose_world_camera/ }).first();
    await node.focus();
    const open = await node.getAttribute('aria-expanded');
    await page.keyboard.press(open === 'true' ? 'ArrowLeft' : 'ArrowRight');
    expect(await node.getAttribute('aria-expanded')).not.toBe(open);
  });
});

describe('accessibility', () => {
  const violations = async (page: import('playwright-core').Page) => {
    await page.evaluate(axeSource());
    const found = await page.evaluate(async () => {
      const axe = (window as unknown as { axe: { run: () => Promise<{ violations: { id: string; nodes: { html: string; failureSummary: string }[] }[] }> } }).axe;
      return (await axe.run()).violations.map((one) => `${one.id}: ${one.nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${node.failureSummary}`).join(' | ')}`);
    });
    return found;
  };
  it.each([['light', 1440, 900], ['dark', 1440, 900], ['light', 800, 1200], ['dark', 800, 1200]] as const)('has no violation: %s at %d x %d', async (scheme, width, height) => {
    const { page } = await visit({ scheme, size: { width, height }, still: true });
    await page.locator('.thumb canvas').first().waitFor();
    expect(await violations(page)).toEqual([]);
    for (const key of ['n', 'q', '3']) await page.keyboard.press(key);
    await choose(page, 'stereo');
    await page.keyboard.press('m');
    await page.locator('details.trace summary').click();
    await page.locator('.trace-node').first().waitFor();
    await page.locator('.quality-bar').first().waitFor();
    await page.locator('.map-canvas').focus();
    await page.keyboard.press('ArrowLeft');
    await page.locator('[data-panel=map]').getByRole('button', { name: 'Recording' }).click();
    await page.locator('[data-panel=plot]').first().getByRole('button', { name: 'Show as a table' }).click();
    await page.locator('[data-panel=plot]').nth(1).getByRole('button', { name: 'Choose series' }).click();
    await page.locator('[data-panel=nights] tbody tr').first().waitFor();
    await page.keyboard.press('f');
    await page.waitForTimeout(800);
    expect(await violations(page)).toEqual([]);
    for (const key of ['?', '/', 'g']) {
      await page.keyboard.press('Escape');
      await page.locator('h1').click();
      await page.keyboard.press(key);
      await page.getByRole('dialog').waitFor();
      expect(await violations(page)).toEqual([]);
      await page.keyboard.press('Escape');
    }
  });
});

describe('what goes wrong', () => {
  it('is said in the panel, which tries again', async () => {
    let isBroken = true;
    const { page } = await visit({ expected: /500/, intercept: (url) => (isBroken && url.pathname === '/api/series' ? refusal(500, 'data loss', "snapshot 'A/B/C/D' is damaged: checksum 5 found, 6 needed") : null) });
    const plot = page.locator('[data-panel=plot]').first();
    await plot.getByRole('alert').getByText(/checksum 5 found/).waitFor();
    isBroken = false;
    await plot.getByRole('button', { name: 'Try again' }).click();
    await plot.locator('.plot-host canvas').waitFor();
    expect(await plot.getByRole('alert').count()).toBe(0);
  });

  it('hostile answers give words and no crash', async () => {
    const { page } = await visit({
      ready: false, intercept: (url) => {
        if (url.pathname === '/api/density') return { status: 200, type: 'application/octet-stream', headers: {}, body: new Uint8Array(7) };
        if (url.pathname === '/api/moment') return json({ id: 5, time: 'x', instances: null });
        if (url.pathname === '/api/members') return json({ members: [{ path: 'image', kind: 'image', shape: [1e99] }, { path: 'x', kind: 'number' }] });
        return null;
      },
    });
    await page.getByText(/7 bytes came/).first().waitFor();
    await page.getByLabel(/^Inspector/).getByRole('alert').getByText(/number at 'id', a text was needed/).waitFor();
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
  });

  it('a gateway that is gone is said, with what to do', async () => {
    const { page } = await visit({ expected: /ERR_|401|Failed/ });
    await page.context().clearCookies();
    await goTo(page, '07:01:00');
    await page.getByText(/Open the address that `engram view` printed/).first().waitFor();
    await page.context().setOffline(true);
    await goTo(page, '07:02:00');
    await page.getByText(/Is `engram view` still running/).first().waitFor();
  });

  it('an empty memory says what to do', async () => {
    const { page } = await visit({
      ready: false, intercept: (url) => url.pathname === '/api/info' ? json({ name: 'engram', version: '1', stores: [{ name: 'new.engram' }], first: null, last: null, entities: 0, snapshots: 0, is_live: false })
        : url.pathname === '/api/tree' ? json({ under: '', children: [] }) : null,
    });
    await page.getByText('This memory is empty').waitFor();
  });

  it('one request is under way for each panel, and the latest wins', async () => {
    const { page, mock } = await visit();
    await page.getByRole('button', { name: 'Close Similar moments' }).click();
    await page.waitForTimeout(500);
    mock.state.delayMs = 150;
    mock.state.requests.length = 0;
    const steps = 80;
    await page.getByTestId('surface').evaluate(async (surface, count) => {
      const box = surface.getBoundingClientRect();
      surface.setPointerCapture = () => {};
      const send = (type: string, x: number) => surface.dispatchEvent(new PointerEvent(type, { pointerId: 5, bubbles: true, button: 0, clientX: box.x + x, clientY: box.y + 8 }));
      send('pointerdown', 100);
      for (let i = 1; i <= count; ++i) {
        send('pointermove', 100 + i * 8);
        await new Promise((done) => requestAnimationFrame(done));
      }
      send('pointerup', 900);
    }, steps);
    await page.waitForTimeout(2500);
    const moments = mock.state.requests.filter((request) => request.startsWith('/api/moment')).length;
    // Two panels ask for moments; without the rule it would be 160.
    expect(moments).toBeLessThan(steps);
    const cursor = await cursorOf(page);
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/moment')).at(-1)!;
    expect(new URLSearchParams(asked.split('?')[1]).get('at')).toBe(String(cursor));
  });
});

describe('a change of one panel', () => {
  it('makes no other ask again', async () => {
    const { page, mock } = await visit();
    await page.locator('.thumb canvas').first().waitFor();
    await page.waitForTimeout(1500);
    mock.state.requests.length = 0;
    await page.locator('[data-panel=plot]').first().getByRole('button', { name: 'Show as a table' }).click();
    await page.waitForTimeout(500);
    expect(mock.state.requests.filter((request) => !request.startsWith('/api/series') && !request.startsWith('/api/predict'))).toEqual([]);
  });
});

describe('a server', () => {
  it('that tells names alone is shown all the same', async () => {
    const node = (id: string, level: string, children?: unknown[]) => ({ id, name: id, level, entities: 1, ...(children ? { children } : {}) });
    const chain = (id: string) => { const [a, b, c] = id.split('/'); return node(a!, 'memory', [node(`${a}/${b}`, 'core', [node(`${a}/${b}/${c}`, 'provider', [node(id, 'entity')])])]); };
    const { page } = await visit({ intercept: (url) => (url.pathname === '/api/tree' ? json({ under: '', children: [chain('Vision/RGB/head/stereo'), chain('RobotState/Proprioception/robot/joints')] }) : null) });
    const kinds = () => page.locator('.panels-main [data-panel]').evaluateAll((all) => all.map((one) => one.getAttribute('data-panel')));
    await expect.poll(kinds).toEqual(['images', 'plot']);
    await page.getByRole('button', { name: 'Panel', exact: true }).click();
    expect(await page.getByRole('button', { name: 'Plot', exact: true }).isEnabled()).toBe(true);
    await page.keyboard.press('Escape');
    await page.locator('h1').click();
    await page.keyboard.press('3');
    await expect.poll(() => page.locator('.scene-label').count()).toBeGreaterThan(0);
  });

  it('with nothing that has a place says so in the scene', async () => {
    const tree = [{ id: 'A', name: 'A', level: 'memory', children: [{ id: 'A/B', name: 'B', level: 'core', children: [{ id: 'A/B/C', name: 'C', level: 'provider', children: [{ id: 'Speech/Commands/human/text', name: 'text', level: 'entity', kinds: ['text'], snapshots: 3 }] }] }] }];
    const { page } = await visit({ expected: /404/, intercept: (url) => (url.pathname === '/api/tree' ? json({ under: '', children: tree }) : null) });
    await page.keyboard.press('3');
    const panel = page.locator('[data-panel=scene]');
    await panel.getByText('Nothing has a place').waitFor();
    expect(await panel.getByRole('alert').count()).toBe(0);
  });

  it('of more entities than fit an answer opens by its first level', async () => {
    const { page } = await visit({
      ready: false, expected: /413|Failed/, intercept: (url) => (url.pathname === '/api/tree' && Number(url.searchParams.get('depth')) > 1 ? refusal(413, 'resource exhausted', 'the answer has 99999999 bytes') : null),
    });
    const vision = page.getByRole('treeitem', { name: /^Vision/ });
    await vision.click();
    await page.getByRole('treeitem', { name: /^RGB/ }).waitFor();
  });
});

describe('a memory that records', () => {
  const liveInfo = () => json({ name: 'engram', version: '1', stores: [{ name: 'robot' }], first: `${kStart}`, last: `${kStart + 1_379_000_000_000n}`, entities: 32, snapshots: 250094, is_live: true, max_horizon_ns: '60000000000' });

  it('stays at the moment that a link leads to', async () => {
    const cursor = kStart + 728_250_000_007n;
    const { page } = await visit({ hash: `#1&t=${cursor.toString(36)}`, intercept: (url) => (url.pathname === '/api/info' ? liveInfo() : null) });
    await page.getByRole('button', { name: 'Follow', exact: true }).waitFor();
    await page.waitForTimeout(1300);
    expect(await cursorOf(page)).toBe(cursor);
  });

  it('puts what came in the place of what was predicted, and says how wrong that was', async () => {
    const { page } = await visit({ intercept: (url) => (url.pathname === '/api/info' ? liveInfo() : null) });
    await page.getByRole('button', { name: 'Live', exact: true }).waitFor();
    await choose(page, 'joints');
    // A commit comes every 500 ms.
    await goTo(page, String((await cursorOf(page)) + 6_900_000_000n));
    const inspector = page.getByLabel(/^Inspector/);
    const source = inspector.locator('.facts').first().locator('.source');
    await expect.poll(() => source.textContent(), { timeout: 5000 }).toBe('predicted');
    const cursor = await cursorOf(page);
    await expect.poll(() => source.textContent(), { timeout: 12_000 }).toBe('recorded');
    const part = inspector.getByLabel('What was predicted');
    await part.getByText(/Predicted \d+(\.\d+)? m?s ahead by related; recorded at 07:\d\d:\d\d\.\d{3}, 100 ms after that time\. \d+ of 86 numbers within the bound \(90 %\)\./).waitFor();
    expect(await part.locator('tbody tr').count()).toBe(8);
    const cells = await part.locator('tbody tr').first().locator('td').allTextContents();
    expect(Math.abs(Number(cells[0]) - Number(cells[1]))).toBeCloseTo(Number(cells[2]), 3);
    expect(['within the bound', 'outside']).toContain(cells[3]);
    expect(await page.locator('.notice').textContent()).toMatch(/^What was predicted has come\. /);
    await part.getByRole('button', { name: /^and \d+ more$/ }).click();
    expect(await part.locator('tbody tr').count()).toBe(86);
    expect(await cursorOf(page)).toBe(cursor);
    await page.keyboard.press('Home');
    await expect.poll(() => part.count()).toBe(0);
  });

  it('asks nothing for what is committed behind the cursor', async () => {
    const { page, mock } = await visit({ hash: `#1&t=${(kStart + 728_250_000_007n).toString(36)}&s=RobotState/Proprioception/robot/joints&p=inspector`, intercept: (url) => (url.pathname === '/api/info' ? liveInfo() : null) });
    await page.getByRole('button', { name: 'Follow', exact: true }).waitFor();
    await page.waitForTimeout(600);
    mock.state.requests.length = 0;
    await page.waitForTimeout(1600);
    expect(mock.state.requests.filter((request) => request.startsWith('/api/moment'))).toEqual([]);
  });

  it('is followed, and pauses when somebody looks back', async () => {
    const { page } = await visit({
      intercept: (url) => (url.pathname === '/api/info' ? liveInfo() : null),
    });
    await page.getByRole('button', { name: 'Live', exact: true }).waitFor();
    const before = await cursorOf(page);
    await page.waitForTimeout(1300);
    expect(await cursorOf(page)).toBeGreaterThan(before);
    await page.keyboard.press('Home');
    await page.getByRole('button', { name: 'Follow', exact: true }).waitFor();
    const paused = await cursorOf(page);
    await page.waitForTimeout(1100);
    expect(await cursorOf(page)).toBe(paused);
  });
});
