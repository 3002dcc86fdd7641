// SPDX-License-Identifier: Apache-2.0
// What a person sees of skills on the timeline: bars, marks, and what the inspector tells of them.
import { readFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { axeSource, coloursOf, cursorOf, json, kStart, useBrowser, visit, type Answer, type VisitOptions } from './browser';
// @ts-expect-error The mock is plain JavaScript.
import { kExecutions, kNavigation, manyExecutions, withSkills } from '@mock/skills.mjs';

useBrowser();

const second = (s: number) => kStart + BigInt(Math.round(s * 1e3)) * 1_000_000n;
const kFrom = second(690);
const kLength = 50_000_000_000n;
const kClosed = ['Objects', 'Vision', 'RobotState', 'Skills/Actions/robot', 'Simulation', 'Speech', 'Tasks', 'Skill/ExecutionRequest'];
const hashAt = (at: number, entity: string, more = '') => `#1&t=${second(at).toString(36)}&v=${kFrom.toString(36)}.${kLength.toString(36)}&s=${entity}&h=560&c=${kClosed.join(',')}&p=inspector${more}`;
const kPick = 'Skill/Event/kitchen/pick';
const kDrive = 'Skill/Event/kitchen/drive';

async function open(options: VisitOptions & { at?: number; entity?: string } = {}) {
  const visited = await visit({ hash: hashAt(options.at ?? 716, options.entity ?? kPick), expected: /404/, intercept: withSkills() as (url: URL) => Answer | null, ...options });
  return { ...visited, told: visited.page.getByRole('region', { name: 'Execution' }) };
}

const rowOf = (page: Page, id: string) => page.locator(`[id="row-${id}"]`);

/** Where a moment of a lane is on the screen. */
async function place(page: Page, at: number, row: string): Promise<{ x: number; y: number }> {
  const surface = (await page.getByTestId('surface').boundingBox())!;
  const name = (await rowOf(page, row).boundingBox())!;
  return { x: surface.x + (surface.width * Number(second(at) - kFrom)) / Number(kLength), y: name.y + name.height / 2 };
}
async function click(page: Page, at: number, row: string, dy = 0) {
  const { x, y } = await place(page, at, row);
  await page.mouse.click(x, y + dy);
}

const kColours = { success: '0,128,93', failure: '193,74,0', stopped: '122,63,160', lost: '104,116,126', running: '0,114,178' };

describe('a lane of a skill', () => {
  it('has a bar for each execution, in the colour of its outcome', async () => {
    const { page } = await open();
    await expect.poll(() => coloursOf(page, '.lanes-canvas')).toEqual(expect.arrayContaining(Object.values(kColours)));
  });

  it('tells of the one that is clicked: parameters, reason, what stopped it, and why', async () => {
    const { page, told } = await open();
    await told.getByText('it slipped').waitFor();
    await click(page, 709, kPick);
    await told.getByRole('heading', { name: /^pick salt_1 right\s*stopped after 4 s/ }).waitFor();
    await told.getByText('its condition does not hold any more').waitFor();
    await told.getByText('Stopped by').waitFor();
    await told.getByText('Bring me the salt.').waitFor();
    expect(await told.getByRole('list', { name: 'Why' }).locator('li').allTextContents()).toEqual([expect.stringMatching(/^planner asked for kitchen\/pick/), expect.stringMatching(/^Ada: Bring me the salt\./)]);
    expect(Number((await cursorOf(page)) - second(709))).toBeLessThan(1e8);
    // Its links lead on, up to the words.
    await told.getByRole('list', { name: 'Why' }).getByRole('button', { name: /^Links to Speech/ }).click();
    await expect.poll(() => page.locator('.entity-path').textContent()).toBe('Speech/Commands/human/text');
  });

  it('has those that overlap below each other, and a click takes the right one', async () => {
    const { page, told } = await open({ entity: kDrive });
    await told.getByText(/success|lost/).first().waitFor();
    await click(page, 724, kDrive, -5);
    await told.getByRole('heading', { name: /^drive table\s*lost after 11 s/ }).waitFor();
    await click(page, 724, kDrive, 5);
    await told.getByRole('heading', { name: /^drive window\s*success after 6 s/ }).waitFor();
  });

  it('has marks for what was refused, with each condition that was not met', async () => {
    const { page } = await open();
    await click(page, 698.5, kPick, 4);
    await expect.poll(() => page.locator('.entity-path').textContent()).toBe('Skill/Refusal/kitchen/pick');
    const meant = page.getByRole('region', { name: 'What was meant' });
    await meant.getByRole('heading', { name: 'pick refused' }).waitFor();
    await meant.getByText("parameters: 'hand': found 'up', needs one of left, right").waitFor();
    await meant.getByText('Hand: closed (found open)').waitFor();
    await meant.getByText('ada asked for kitchen/pick').waitFor();
  });

  it('says what lies below the pointer', async () => {
    const { page } = await open();
    const titleAt = async (at: number, row: string, dy = 0) => {
      const { x, y } = await place(page, at, row);
      await page.mouse.move(x, y + dy);
      return page.getByTestId('surface').getAttribute('title');
    };
    await expect.poll(() => titleAt(716, kPick)).toBe('pick salt_1 right: failure after 5 s: it slipped');
    expect(await titleAt(703, kDrive)).toBe("drive counter: success after 6 s: stands at 'counter'");
    expect(await titleAt(702, 'Navigation/Event/robot/drive')).toBe('counter: blocked: chair_1 is in the way');
    expect(await titleAt(696, kPick)).toBe('');
  });

  it('shows all skills of a provider while it is closed', async () => {
    const { page } = await open();
    const kitchen = rowOf(page, 'Skill/Event/kitchen');
    await kitchen.click();
    await expect.poll(() => kitchen.getAttribute('aria-expanded')).toBe('false');
    await expect.poll(async () => { await click(page, 716, 'Skill/Event/kitchen'); return page.locator('.entity-path').textContent(); }).toBe(kPick);
  });

  it('is walked through by keys and buttons, and listed for who sees no bars', async () => {
    const { page, told } = await open();
    await told.getByRole('button', { name: 'Execution before on the screen' }).press('Enter');
    await told.getByRole('heading', { name: /stopped/ }).waitFor();
    expect(await told.getByRole('button', { name: 'Execution before on the screen' }).isDisabled()).toBe(true);
    await told.getByText('2 executions on the screen').click();
    expect(await told.locator('tbody tr').allTextContents()).toEqual([expect.stringMatching(/^pick salt_1 rightstopped.*4 s$/), expect.stringMatching(/^pick salt_1 rightfailure.*5 s$/)]);
    await told.locator('tbody button').nth(1).click();
    await told.getByText('it slipped').waitFor();
    expect(await cursorOf(page)).toBe(second(713));
    await page.locator('h1').click();
    await page.keyboard.press('ArrowRight');
    await expect.poll(() => cursorOf(page)).toBe(second(718));
  });

  it('tells reports, and that it runs', async () => {
    const { told } = await open({ entity: 'Skill/Event/planner/bring', at: 720 });
    await told.getByRole('heading', { name: /^bring\s*runs/ }).waitFor();
    await told.getByText('its condition, which starts planner/bring').waitFor();
    expect(await told.locator('details ol li').allTextContents()).toEqual([expect.stringMatching(/^\+7 s the drive is done/), expect.stringMatching(/^\+19 s the pick failed/)]);
  });

  it('is in the picture that is saved', async () => {
    const { page, told } = await open();
    await told.getByText('it slipped').waitFor();
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Save the timeline as SVG' }).click();
    const svg = readFileSync(await (await waiting).path(), 'utf8');
    expect(svg).toContain('>pick salt_1 right<');
    expect(svg).toContain('>drive counter<');
    expect(svg).toMatch(/stroke="#c14a00"/);
  });
});

describe('very many executions', () => {
  const many = () => withSkills({ executions: [...kExecutions, ...manyExecutions(5000)], more: kNavigation }) as (url: URL) => Answer | null;
  it('are drawn by pixels, and asked for one by one where they can be told apart', async () => {
    const kLook = 'Skill/Event/kitchen/look';
    const { page, mock, told } = await open({ intercept: many(), hash: `#1&t=${second(700.05).toString(36)}&s=${kLook}&h=560&c=${kClosed.join(',')}&p=inspector` });
    await expect.poll(() => coloursOf(page, '.lanes-canvas')).toEqual(expect.arrayContaining([kColours.success, kColours.failure]));
    const asked = (path: string) => mock.state.requests.filter((one) => one.startsWith(path)).map((one) => decodeURIComponent(one).replaceAll('+', ' '));
    expect(asked('/api/series').some((one) => one.includes(kLook) && one.includes('path=outcome'))).toBe(true);
    expect(asked('/api/query').some((one) => one.includes(`${kLook} @`))).toBe(false);
    await page.locator('h1').click();
    for (let i = 0; i < 6; ++i) await page.keyboard.press('+');
    await expect.poll(() => asked('/api/query').some((one) => one.includes(`${kLook} @`))).toBe(true);
    await told.getByText(/^\d+ executions on the screen$/).waitFor();
    await told.getByRole('heading', { name: /^look\s*success after 100 ms/ }).waitFor();
  });

  it('moving a little asks for nothing', async () => {
    const { page, mock, told } = await open();
    await told.getByText('it slipped').waitFor();
    await page.waitForTimeout(800);
    mock.state.requests.length = 0;
    await page.keyboard.press('Shift+Tab');
    await page.mouse.move(900, 300);
    await page.mouse.down();
    await page.mouse.move(960, 300, { steps: 4 });
    await page.mouse.up();
    await page.waitForTimeout(800);
    expect(mock.state.requests.filter((one) => one.startsWith('/api/query'))).toEqual([]);
  });
});

describe('a memory that runs skills', () => {
  it('lets a bar grow until the last snapshot, wherever that is', async () => {
    const info = json({ name: 'engram', version: '1', stores: [{ name: 'robot' }], first: `${kStart}`, last: `${second(1379)}`, entities: 40, snapshots: 250094, is_live: true, max_horizon_ns: '60000000000' });
    const skills = withSkills() as (url: URL) => Answer | null;
    const from = second(1370);
    const { page } = await open({
      intercept: (url) => (url.pathname === '/api/info' ? info : skills(url)),
      hash: `#1&t=${second(1375).toString(36)}&v=${from.toString(36)}.${(30_000_000_000n).toString(36)}&s=Skill/Event/planner/bring&h=560&c=${kClosed.join(',')}&p=inspector`,
    });
    await page.getByRole('button', { name: 'Follow', exact: true }).waitFor();
    const name = rowOf(page, 'Skill/Event/planner/bring');
    const reach = async () => {
      const top = (await name.boundingBox())!.y - (await page.getByTestId('surface').boundingBox())!.y - 26;
      return page.locator('.lanes-canvas').evaluate((element, y) => {
        const canvas = element as HTMLCanvasElement;
        const { data, width } = canvas.getContext('2d')!.getImageData(0, Math.round(y) + 3, canvas.width, 1);
        let last = -1;
        for (let x = 0; x < width; ++x) if (data[4 * x]! < 60 && data[4 * x + 2]! > 120 && data[4 * x + 3]! > 100) last = x;
        return last;
      }, top);
    };
    await expect.poll(reach).toBeGreaterThan(0);
    const before = await reach();
    await expect.poll(reach, { timeout: 8000 }).toBeGreaterThan(before + 30);
  });
});

describe('skills for everybody', () => {
  it.each(['light', 'dark'] as const)('have no violation of accessibility: %s', async (scheme) => {
    const { page, told } = await open({ scheme, still: true });
    await told.getByText('2 executions on the screen').click();
    await page.evaluate(axeSource());
    const violations = await page.evaluate(async () => {
      const axe = (window as unknown as { axe: { run: () => Promise<{ violations: { id: string; nodes: { html: string; failureSummary: string }[] }[] }> } }).axe;
      return (await axe.run()).violations.map((one) => `${one.id}: ${one.nodes.map((node) => `${node.html.slice(0, 160)} ${node.failureSummary}`).join(' | ')}`);
    });
    expect(violations).toEqual([]);
  });
});
