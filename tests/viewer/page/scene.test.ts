// SPDX-License-Identifier: Apache-2.0
// What a person sees in the scene: the robot, its ghost, and points.
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { goTo, json, kStart, useBrowser, visit, type Answer, type VisitOptions } from './browser';
// @ts-expect-error The mock is plain JavaScript.
import { urdfWith } from '@mock/robot.mjs';
// @ts-expect-error The mock is plain JavaScript.
import { answer } from '@mock/handler.mjs';

useBrowser();

const kDescription = 'RobotState/Description/robot/body';
const kJoints = 'RobotState/Proprioception/robot/joints';
const kAt = kStart + 700_000_000_000n;
const hashAt = (time: bigint) => `#1&t=${time.toString(36)}&s=${kJoints}&p=inspector`;

/** Gives the description of the robot another URDF; none where it is null. */
const withUrdf = (urdf: string | null) => (url: URL): Answer | null => {
  if (url.pathname !== '/api/moment' || url.searchParams.get('entity') !== kDescription) return null;
  const told = answer(url) as Answer;
  const moment = JSON.parse(String(told.body)) as { instances: { data: Record<string, unknown> }[] };
  if (urdf === null) delete moment.instances[0]!.data.urdf;
  else moment.instances[0]!.data.urdf = urdf;
  return json(moment);
};

async function openScene(options: VisitOptions = {}) {
  const visited = await visit({ hash: hashAt(kAt), expected: /404/, ...options });
  await visited.page.keyboard.press('3');
  const panel = visited.page.locator('[data-panel=scene]');
  await panel.locator('canvas').waitFor();
  return { ...visited, panel, notes: panel.getByLabel('Notes on the scene') };
}

/** x, y, z of a row of the table of places. */
async function placeOf(page: Page, row: string): Promise<number[]> {
  const panel = page.locator('[data-panel=scene]');
  const table = panel.getByRole('button', { name: 'Show places as a table' });
  if ((await table.getAttribute('aria-pressed')) !== 'true') await table.click();
  const found = panel.locator('tbody tr').filter({ has: page.getByText(row, { exact: true }) }).first();
  await found.waitFor();
  return (await found.locator('td').allTextContents()).slice(0, 3).map((text) => Number(text.replace('−', '-').replace(/\s/g, '')));
}

const numbersOf = (page: Page, entity: string, at: bigint) => page.evaluate(async ([id, time]) => {
  const told = await (await fetch(`/api/moment?entity=${encodeURIComponent(id!)}&at=${time}`)).json();
  return told.instances[0].data as Record<string, { $ndarray: { data: number[] } }>;
}, [entity, String(at)] as const);

describe('the robot', () => {
  it('stands where its platform is, with its joints as they are', async () => {
    const { page, panel } = await openScene();
    await expect.poll(() => panel.locator('.scene').getAttribute('aria-label')).toContain('and a robot');
    const platform = (await numbersOf(page, 'RobotState/Localization/robot/platform', kAt)) as unknown as { x: number; y: number };
    const [lift] = (await numbersOf(page, kJoints, kAt)).positions!.$ndarray.data;
    const [x, y, z] = await placeOf(page, 'platform');
    expect(x).toBeCloseTo(platform.x, 3);
    expect(y).toBeCloseTo(platform.y, 3);
    expect(z).toBe(0);
    const torso = await placeOf(page, 'torso');
    expect(torso[0]).toBeCloseTo(platform.x, 3);
    expect(torso[2]).toBeCloseTo(0.85 + lift!, 3);
    expect(await panel.locator('tbody tr').filter({ hasText: 'predicted' }).count()).toBe(0);
  });

  it('comes with its loader, which no other scene has', async () => {
    const scripts = (page: Page) => page.evaluate(() => performance.getEntriesByType('resource').map((one) => one.name).filter((name) => /robot-[^/]*\.js/.test(name)).length);
    const { page, panel } = await openScene({ intercept: withUrdf(null) });
    await expect.poll(() => panel.locator('.scene-label').count()).toBeGreaterThan(2);
    expect(await scripts(page)).toBe(0);
    expect(await panel.getByLabel('predict ahead').count()).toBe(0);
    expect(await panel.locator('.scene').getAttribute('aria-label')).not.toContain('robot');
    const other = await openScene();
    await expect.poll(() => scripts(other.page)).toBe(1);
  });

  it('has a ghost where it will be', async () => {
    const { page, panel } = await openScene();
    await panel.getByLabel('predict ahead').selectOption('+400 ms');
    await placeOf(page, 'hand_left, predicted');
    await panel.getByLabel('predict ahead').selectOption('off');
    await expect.poll(() => panel.locator('tbody tr').filter({ hasText: 'predicted' }).count()).toBe(0);
    await page.locator('h1').click();
    await page.keyboard.press('f');
    await placeOf(page, 'hand_left, predicted');
    // The one that was recorded last stands there, too.
    await placeOf(page, 'hand_left');
  });
});

const box = '<geometry><box size="0.1 0.1 0.1"/></geometry>';
const two = (a: string, b: string) => `<robot name="x"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="${a}"/><child link="${b}"/></joint><joint name="k" type="fixed"><parent link="${b}"/><child link="${a}"/></joint></robot>`;
const one = (inside: string) => `<robot name="x"><link name="a">${inside}</link></robot>`;

const kHostile: [string, string, RegExp][] = [
  ['defines entities that grow', `<!DOCTYPE robot [<!ENTITY a "${'b'.repeat(99)}"><!ENTITY c "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]><robot name="&c;"/>`, /entities of XML/],
  ['is no XML', '<robot name="x"><link', /is no XML/],
  ['is huge', `<robot name="x"><!--${'x'.repeat(4_000_001)}--></robot>`, /at most 4000000/],
  ['has too many elements', `<robot name="x">${'<y/>'.repeat(20_001)}</robot>`, /20001 elements/],
  ['is as deep as it is long', `<robot name="x">${'<y>'.repeat(15_000)}${'</y>'.repeat(15_000)}</robot>`, /no XML|no links/],
  ['has links in a circle', two('a', 'b'), /circle/],
  ['has no number where one belongs', one(`<visual><origin xyz="0 nan 0"/>${box}</visual>`), /'0 nan 0' for xyz of link 'a'/],
  ['has an endless box', one('<visual><geometry><box size="1 1 1e999"/></geometry></visual>'), /the box of link 'a'/],
  ['has a joint of no type', two('a', 'b').replace('revolute', 'warp'), /type of joint 'j' of the URDF is 'warp'/],
  ['has names that are none', '<robot name="x"><link name="__proto__"/></robot>', /'__proto__', which is no name/],
];

describe('a URDF', () => {
  it.each(kHostile)('that %s is not drawn, and says so', async (_, urdf, why) => {
    // Chromium says what is wrong with XML in a document with styles, which the policy refuses.
    const { page, panel, notes } = await openScene({ intercept: withUrdf(urdf), expected: /404|Applying inline style violates/ });
    await notes.getByText(why).waitFor();
    // The rest of the scene is there, and the page goes on.
    await expect.poll(() => panel.locator('.scene-label').count()).toBeGreaterThan(2);
    expect(await page.evaluate(() => 1 + 1)).toBe(2);
    expect(await panel.locator('.scene').getAttribute('aria-label')).not.toContain('robot');
  });

  it('that names files is drawn without them, and asks for none', async () => {
    const mesh = (url: string) => `<visual><geometry><mesh filename="${url}"/></geometry></visual>`;
    const extra = `<link name="extra">${mesh('package://robot/a.stl')}${mesh('http://127.0.0.1:9/b.dae')}<VISUAL><Geometry><MESH filename="/c.stl"/></Geometry></VISUAL>
      <visual>${box}<material name="m"><texture filename="http://127.0.0.1:9/t.png"/></material></visual><visual>${box}<Material name="n"><Texture filename="package://robot/t.png"/></Material></visual></link>
      <joint name="extra_joint" type="fixed"><parent link="head"/><child link="extra"/></joint>`;
    const { page, mock, notes } = await openScene({ intercept: withUrdf(urdfWith(extra)) });
    await notes.getByText('3 shapes of the robot are not drawn: the memory has no meshes.').waitFor();
    await placeOf(page, 'extra');
    await page.waitForTimeout(500);
    expect(mock.state.requests.filter((request) => /stl|dae|png/.test(request))).toEqual([]);
    const asked = await page.evaluate(() => performance.getEntriesByType('resource').map((one) => new URL(one.name).pathname));
    expect(asked.filter((path) => !/^\/(api|assets)\//.test(path))).toEqual([]);
  });

  it('whose joints nobody tells stands still, and says so', async () => {
    const lone = '<joint name="antenna" type="revolute"><parent link="head"/><child link="tip"/><axis xyz="0 0 1"/></joint><link name="tip"/>';
    const { notes } = await openScene({ intercept: withUrdf(urdfWith(lone)) });
    await notes.getByText('1 of 44 joints are not told, and stay at zero.').waitFor();
  });
});

describe('cameras', () => {
  it('show what they see, once the cursor rests', async () => {
    const { page, mock, panel } = await openScene({ hash: `${hashAt(kAt)}&h=140` });
    const seen = () => mock.state.requests.filter((request) => request.startsWith('/api/image') && request.includes('stereo') && request.includes('as=jpeg'));
    // Its frustum, and the colours of the points that the same camera measured.
    await expect.poll(() => seen().length, { timeout: 10_000 }).toBeGreaterThanOrEqual(2);
    await page.waitForTimeout(1000);
    const before = seen().length;
    await panel.getByRole('button', { name: 'Show places as a table' }).click();
    await page.waitForTimeout(1000);
    expect(seen().length).toBe(before);
    await page.locator('h1').click();
    await goTo(page, '07:05:00');
    await expect.poll(() => seen().length, { timeout: 10_000 }).toBeGreaterThan(before);
  });
});

describe('points', () => {
  it('of a depth image are drawn, and taken away', async () => {
    const { mock, panel, notes } = await openScene();
    await notes.getByText('left: 16\u2009384 points.').waitFor();
    const asked = () => mock.state.requests.filter((request) => request.startsWith('/api/cloud'));
    // The calibration that the image links to tells how the camera sees; depth is in mm.
    expect(asked().at(-1)).toMatch(/fx=96\.5.*unit=0\.001/);
    mock.state.requests.length = 0;
    await panel.getByLabel('points', { exact: true }).uncheck();
    await expect.poll(() => notes.getByText('points').count()).toBe(0);
    expect(asked()).toEqual([]);
  });

  it('that are too many say how many of how many are there', async () => {
    const few: Answer = { status: 200, type: 'application/octet-stream', headers: { 'X-Engram-Points': '2', 'X-Engram-Total': '700000' }, body: new Uint8Array(Float32Array.of(0, 0, 1, 1, 0, 2).buffer) };
    const { notes } = await openScene({ intercept: (url) => (url.pathname === '/api/cloud' ? few : null) });
    await notes.getByText('left: 2 of 700\u2009000 points.').waitFor();
  });

  it('that are no points are told as such', async () => {
    const odd: Answer = { status: 200, type: 'application/octet-stream', headers: {}, body: new Uint8Array(13) };
    const { panel, notes } = await openScene({ intercept: (url) => (url.pathname === '/api/cloud' ? odd : null) });
    await notes.getByText('13 bytes came, a multiple of 12 was needed').waitFor();
    await expect.poll(() => panel.locator('.scene').getAttribute('aria-label')).toContain('and a robot');
  });
});

describe('a scene that is live', () => {
  it('asks for what was committed, and for nothing else', async () => {
    const info = json({ name: 'engram', version: '1', stores: [{ name: 'robot' }], first: `${kStart}`, last: `${kStart + 1_379_000_000_000n}`, entities: 32, snapshots: 250094, is_live: true, max_horizon_ns: '60000000000' });
    const { page, mock, panel } = await openScene({ hash: `#1&s=${kJoints}&p=inspector`, intercept: (url) => (url.pathname === '/api/info' ? info : null) });
    await page.getByRole('button', { name: 'Live', exact: true }).waitFor();
    await expect.poll(() => panel.locator('.scene').getAttribute('aria-label')).toContain('and a robot');
    await page.waitForTimeout(1500);
    mock.state.requests.length = 0;
    await page.waitForTimeout(2500);
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/moment')).map((request) => new URL(request, mock.address).searchParams.get('entity'));
    expect(new Set(asked)).toEqual(new Set([kJoints]));
    expect(mock.state.requests.filter((request) => request.startsWith('/api/cloud'))).toEqual([]);
  });
});
