// SPDX-License-Identifier: Apache-2.0
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { axeSource, cursorOf, json, kStart, refusal, useBrowser, visit } from './browser';

useBrowser();

const hashOf = (part: string, more = '') => `#1&s=Vision/RGB/head/stereo&p=nights~~~part.${part}${more};inspector`;
const panelOf = (page: Page) => page.locator('[data-panel=nights]');
const chosen = (page: Page) => page.locator('.entity-path').textContent();
const clipboard = (page: Page) => page.evaluate(() => navigator.clipboard.readText());

describe('the parts of nights and bytes', () => {
  it('are chosen by buttons, and stay in the address', async () => {
    const { page, context } = await visit();
    await page.keyboard.press('n');
    const parts = panelOf(page).getByRole('group', { name: 'Parts of nights and bytes' });
    await parts.getByRole('button', { name: 'Bytes', pressed: true }).waitFor();
    await parts.getByRole('button', { name: 'Nights' }).focus();
    await page.keyboard.press('Enter');
    await panelOf(page).getByRole('list', { name: 'Nights' }).waitFor();
    await expect.poll(() => new URL(page.url()).hash).toContain('part.nights');
    const other = await context.newPage();
    await other.goto(page.url());
    await panelOf(other).getByRole('list', { name: 'Nights' }).waitFor();
  });
});

describe('nights', () => {
  it('are told newest first, and each opens to what it did', async () => {
    const { page } = await visit({ hash: hashOf('nights') });
    const heads = panelOf(page).locator('.night-head');
    await heads.first().waitFor();
    expect(await heads.count()).toBe(4);
    expect(await heads.nth(0).textContent()).toMatch(/forgot.*9\.8 MB → 7\.1 MB \(−28 %\).*2 210 faded, 5 120 forgotten/);
    expect(await heads.nth(1).textContent()).toMatch(/learned.*31\.4 MB → 9\.8 MB \(−69 %\).*124 090 snapshots encoded, 15 new models/);
    await heads.nth(2).click();
    await panelOf(page).getByText('It ended early: stopped by SIGTERM').waitFor();
    await panelOf(page).getByText('the time was over before anything was encoded').waitFor();
    await heads.nth(1).click();
    expect(await heads.nth(2).getAttribute('aria-expanded')).toBe('false');
    const table = panelOf(page).getByRole('region', { name: /^What the night of 2026-01-01 23:22:59/ });
    expect(await table.locator('thead').textContent()).toBe('entitylearned fromencodedlatents alonebeforeafterPSNRworstmodels');
    expect(await table.locator('tbody tr').first().textContent()).toBe('Vision/RGB/head/stereo10 46913 0879 161489 MB25.7 MB36.2 dB35.0 dB+v3 −v2');
    await table.getByRole('button', { name: 'RobotState/Proprioception/robot/joints' }).click();
    await expect.poll(() => chosen(page)).toBe('RobotState/Proprioception/robot/joints');
  });

  it('have their own reflection, whose findings lead to their moments', async () => {
    const { page } = await visit({ hash: hashOf('nights') });
    const heads = panelOf(page).locator('.night-head');
    await heads.nth(1).click();
    await panelOf(page).getByText(/of 2026-01-02 04:22:59.*: 3 faults and 2 notes/).waitFor();
    const findings = panelOf(page).getByRole('list', { name: 'Findings' }).locator('li');
    expect(await findings.count()).toBe(5);
    await findings.nth(1).locator('.chip').click();
    await expect.poll(() => chosen(page)).toBe('Skills/Actions/robot/pick');
    const seconds = Number((await cursorOf(page)) - kStart) / 1e9;
    expect(seconds).toBeGreaterThanOrEqual(660);
    expect(seconds).toBeLessThan(675);
    // The reflection of the night before is another one.
    await heads.nth(3).click();
    await panelOf(page).getByText(/: 1 fault$/).waitFor();
    // Nobody reflected between the night that was stopped and the next one.
    await heads.nth(2).click();
    await panelOf(page).getByText('No reflection was recorded after this night').waitFor();
  });

  it('are walked and opened by keys', async () => {
    const { page } = await visit({ hash: hashOf('nights') });
    const heads = panelOf(page).locator('.night-head');
    await heads.first().focus();
    const lane = await chosen(page);
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowUp');
    expect(await heads.nth(1).evaluate((head) => document.activeElement === head)).toBe(true);
    await page.keyboard.press('Enter');
    expect(await heads.nth(1).getAttribute('aria-expanded')).toBe('true');
    await page.keyboard.press(' ');
    expect(await heads.nth(1).getAttribute('aria-expanded')).toBe('false');
    expect(await chosen(page)).toBe(lane);
  });

  it('that nobody wrote down, or that are damaged, are said', async () => {
    let answer: object = { entities: [], nights: [], unreadable: 0, more: false };
    const { page } = await visit({ hash: hashOf('nights'), intercept: (url) => (url.pathname === '/api/nights' ? json(answer) : null) });
    await panelOf(page).getByText('No night is written down yet').waitFor();
    answer = { entities: [], nights: [{ work: 'consolidate', began: '5', ended: '6', entities: [] }], unreadable: 2, more: true };
    await panelOf(page).getByRole('button', { name: 'Reflection' }).click();
    await panelOf(page).getByRole('button', { name: 'Nights', exact: true }).click();
    await panelOf(page).getByText('There are older nights, which are not shown. 2 records of nights cannot be read.').waitFor();
    await panelOf(page).locator('.night-head').click();
    await panelOf(page).getByText('No entity had anything new.').waitFor();
  });
});

describe('a reflection', () => {
  it('has findings that lead to their moment and their entity', async () => {
    const { page } = await visit({ hash: hashOf('reflection') });
    await panelOf(page).getByText('3 faults and 2 notes').waitFor();
    const findings = panelOf(page).getByRole('list', { name: 'Findings' }).locator('li');
    expect(await findings.nth(2).textContent()).toMatch(/A spike fault.*robot\/joints.*positions\[3\]: found 2\.41 rad away and back, expected steps of 0\.04 rad/);
    await findings.nth(2).locator('.chip').click();
    expect(Math.round(Number((await cursorOf(page)) - kStart) / 1e9)).toBe(301);
    await expect.poll(() => chosen(page)).toBe('RobotState/Proprioception/robot/joints');
    const before = await cursorOf(page);
    await findings.nth(0).getByRole('button', { name: 'Vision/RGB/head/stereo' }).click();
    await expect.poll(() => chosen(page)).toBe('Vision/RGB/head/stereo');
    expect(await cursorOf(page)).toBe(before);
    await panelOf(page).getByRole('button', { name: 'dead-link 1' }).click();
    expect(await findings.count()).toBe(1);
    await panelOf(page).getByText('pick failure → navigate success → pick success').waitFor();
    expect(await panelOf(page).locator('.rates tbody tr').first().textContent()).toBe('pick85 %9276 to 91 %4.2 s');
  });

  it('of another time is chosen, and one of now is asked for and called off', async () => {
    const { page, mock } = await visit({ hash: hashOf('reflection') });
    await panelOf(page).getByText('3 faults and 2 notes').waitFor();
    const recorded = panelOf(page).getByLabel('Recorded');
    await recorded.selectOption({ index: 1 });
    await panelOf(page).getByText('1 fault', { exact: true }).waitFor();
    await panelOf(page).getByRole('button', { name: 'Look now' }).click();
    await panelOf(page).getByText(/which is not recorded/).waitFor();
    mock.state.delayMs = 3000;
    await panelOf(page).getByRole('button', { name: 'Look now' }).click();
    await panelOf(page).getByRole('button', { name: 'Stop' }).click();
    await panelOf(page).getByRole('button', { name: 'Look now' }).waitFor();
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/reflection'));
    expect(asked.at(-1)).toMatch(/page=\w+&stop=1/);
    expect(asked.at(-2)).toMatch(/look=1/);
    expect(/page=(\w+)/.exec(asked.at(-1)!)![1]).toBe(/page=(\w+)/.exec(asked.at(-2)!)![1]);
  });

  it('that was never recorded is no failure, and shows nothing that a name has in it', async () => {
    const finding = { kind: '<b>x</b>', severity: 'fault', entity: 'A/B/C/<img src=x onerror=alert(1)>', first_snapshot: 'A/B/C/D/5', found: '<script>', expected: '' };
    let answer = refusal(404, 'not found', "no reflection was recorded: 'engram reflect --commit' looks at the memory");
    const { page } = await visit({ hash: hashOf('reflection'), expected: /404/, intercept: (url) => (url.pathname === '/api/reflection' && url.searchParams.get('stop') === null ? answer : null) });
    await panelOf(page).getByText('No reflection yet').waitFor();
    expect(await page.getByRole('alert').count()).toBe(0);
    answer = json({ time: '5', is_recorded: false, findings: Array.from({ length: 250 }, () => finding) });
    await panelOf(page).getByRole('button', { name: 'Look now' }).click();
    await panelOf(page).getByText('250 faults').waitFor();
    expect(await panelOf(page).locator('.findings > li').count()).toBe(100);
    await panelOf(page).getByRole('button', { name: 'Show 150 more' }).click();
    expect(await panelOf(page).locator('.findings > li').count()).toBe(250);
    expect(await page.locator('img').count()).toBe(0);
  });
});

describe('what forgetting would do', () => {
  it('is a picture with numbers, from a form, and a command to copy', async () => {
    const { page, mock } = await visit({ hash: hashOf('forgetting') });
    const panel = panelOf(page);
    await panel.getByLabel('Entities').fill('Vision');
    await panel.getByLabel('Go when older than').fill('12min');
    await panel.getByLabel('Fade when older than').fill('5min');
    await page.keyboard.press('Enter');
    await panel.getByText(/^27 179 of 250 094 snapshots would go, about 412 MB; 7 184 would fade/).waitFor();
    expect(await panel.getByRole('list', { name: 'Why' }).locator('li').allTextContents()).toEqual(['27 179 go: older than 12min', '7 184 fade to 32 dB: older than 5min', 'goes fades stays']);
    const rows = panel.locator('.plan tbody tr');
    expect(await rows.count()).toBe(33);
    const first = await rows.nth(1).locator('th, td').allTextContents();
    expect([first[0], first[2], first[3], first[4]]).toEqual(['Vision/RGB/head/stereo', '12 077', '3 590', '14 096']);
    // What goes lies on the left, what stays on the right.
    const box = async (part: string) => (await rows.nth(1).locator(`.plan-lane .${part}`).boundingBox())!;
    const [gone, fades, stays] = await Promise.all([box('gone'), box('fades'), box('stays')]);
    expect(gone.x).toBeLessThan(fades.x);
    expect(fades.x).toBeLessThan(stays.x);
    // A lane in which everything stays has nothing of the others.
    expect(await panel.locator('.plan tr.whole').first().locator('.plan-lane .gone').getAttribute('d')).toBe('');
    const lane = (await rows.nth(1).locator('.plan-lane').boundingBox())!;
    await page.mouse.click(lane.x + lane.width / 4, lane.y + 5);
    expect(Math.abs(Number((await cursorOf(page)) - kStart) / 1e9 - 23 * 15)).toBeLessThan(10);
    await expect.poll(() => chosen(page)).toBe('Vision/RGB/head/stereo');
    await panel.getByRole('button', { name: 'Copy engram forget' }).click();
    expect(await clipboard(page)).toMatch(/^cat > forget\.yaml <<'END'\nforget:\n[^]*match: 'Vision'[^]*\nEND\nengram forget \/data\/kitchen\.engram --config forget\.yaml$/);
    expect(new URL(page.url()).hash).toMatch(/older_than\.12min/);
    // All that the page asked are questions.
    expect(mock.state.requests.every((request) => request.startsWith('/api/'))).toBe(true);
  });

  it('opens again from the address', async () => {
    const { page } = await visit({ hash: hashOf('forgetting', ',older_than.12min') });
    await panelOf(page).getByText(/snapshots would go/).waitFor();
    expect(await panelOf(page).getByLabel('Go when older than').inputValue()).toBe('12min');
  });

  it('names the field that is wrong, and goes on once it is right', async () => {
    const { page } = await visit({ hash: hashOf('forgetting'), expected: /400/ });
    const panel = panelOf(page);
    await panel.getByRole('button', { name: 'Show what would go' }).click();
    await panel.getByRole('alert').getByText(/nothing says what is to go/).waitFor();
    const age = panel.getByLabel('Go when older than');
    await age.fill('soon');
    await page.keyboard.press('Enter');
    await panel.getByRole('alert').getByText("“Go when older than”: found 'soon', needs a duration such as 12h or 7d").waitFor();
    expect(await age.getAttribute('aria-invalid')).toBe('true');
    expect(await panel.getByLabel('Store at most').getAttribute('aria-invalid')).toBe('false');
    await age.fill('1h');
    await page.keyboard.press('Enter');
    await panel.getByText(/^0 of 250 094 snapshots would go/).waitFor();
    expect(await panel.getByRole('alert').count()).toBe(0);
    expect(await age.getAttribute('aria-invalid')).toBe('false');
  });

  it('takes a configuration as it is', async () => {
    const { page, mock } = await visit({ hash: hashOf('forgetting'), expected: /400/ });
    const panel = panelOf(page);
    await panel.getByRole('button', { name: 'As YAML' }).click();
    const config = panel.getByLabel('Configuration');
    await config.fill('x: 1');
    await panel.getByRole('button', { name: 'Show what would go' }).click();
    await panel.getByRole('alert').getByText("policy:1: has no key 'forget', needs one").waitFor();
    expect(await config.getAttribute('aria-invalid')).toBe('true');
    await config.fill('forget:\n  rules:\n    - {older_than: 12min}\n');
    await panel.getByRole('button', { name: 'Show what would go' }).click();
    await panel.getByText(/^115 362 of 250 094 snapshots would go/).waitFor();
    const asked = mock.state.requests.filter((request) => request.startsWith('/api/forgetting')).at(-1)!;
    expect(new URL(asked, 'http://x').searchParams.get('config')).toBe('forget:\n  rules:\n    - {older_than: 12min}\n');
    await panel.getByRole('button', { name: 'Copy engram forget' }).click();
    expect(await clipboard(page)).toContain('\n    - {older_than: 12min}\nEND\nengram forget');
  });

  it('is stopped where it takes long', async () => {
    const { page, mock } = await visit({ hash: hashOf('forgetting') });
    const panel = panelOf(page);
    await panel.getByLabel('Go when older than').fill('12min');
    mock.state.delayMs = 4000;
    await page.keyboard.press('Enter');
    await panel.getByText('planning ...').waitFor();
    await panel.getByRole('button', { name: 'Stop' }).click();
    await panel.getByRole('button', { name: 'Show what would go' }).waitFor();
    expect(mock.state.requests.filter((request) => request.startsWith('/api/forgetting')).at(-1)).toMatch(/page=\w+&stop=1/);
    mock.state.delayMs = 0;
    await panel.getByRole('button', { name: 'Show what would go' }).click();
    await panel.getByText(/snapshots would go/).waitFor();
  });

  it('is not known of a server, and that is said', async () => {
    const { page, mock } = await visit({
      hash: hashOf('forgetting'), expected: /409/,
      intercept: (url) => (url.pathname === '/api/info' ? json({ name: 'robot', version: '1', stores: [{ name: 'robot' }], entities: 32, first: String(kStart), last: String(kStart + 1_379_983_307_030n), is_live: false })
        : url.pathname === '/api/nights' ? refusal(409, 'failed precondition', "'robot': a server does not tell this; open its store") : null),
    });
    await panelOf(page).getByText('A server does not tell this').waitFor();
    expect(mock.state.requests.some((request) => request.startsWith('/api/forgetting'))).toBe(false);
    await panelOf(page).getByRole('button', { name: 'Reflection' }).click();
    await panelOf(page).getByText('3 faults and 2 notes').waitFor();
    expect(await panelOf(page).getByRole('button', { name: 'Look now' }).count()).toBe(0);
    await panelOf(page).getByRole('button', { name: 'Nights', exact: true }).click();
    await panelOf(page).getByRole('alert').getByText(/a server does not tell this/).waitFor();
  });
});

describe('accessibility of nights', () => {
  it.each([['light', 1440, 900], ['dark', 800, 1200]] as const)('has no violation: %s at %d x %d', async (scheme, width, height) => {
    const { page } = await visit({ hash: hashOf('nights'), scheme, size: { width, height }, still: true });
    await page.evaluate(axeSource());
    const violations = () => page.evaluate(async () => {
      const axe = (window as unknown as { axe: { run: () => Promise<{ violations: { id: string; nodes: { html: string; failureSummary: string }[] }[] }> } }).axe;
      return (await axe.run()).violations.map((one) => `${one.id}: ${one.nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${node.failureSummary}`).join(' | ')}`);
    });
    await panelOf(page).locator('.night-head').nth(1).click();
    await panelOf(page).locator('.findings > li').first().waitFor();
    expect(await violations()).toEqual([]);
    await panelOf(page).getByRole('button', { name: 'Reflection' }).click();
    await panelOf(page).locator('.rates').waitFor();
    expect(await violations()).toEqual([]);
    await panelOf(page).getByRole('button', { name: 'Forgetting' }).click();
    await panelOf(page).getByLabel('Go when older than').fill('12min');
    await page.keyboard.press('Enter');
    await panelOf(page).locator('.plan-lane').first().waitFor();
    expect(await violations()).toEqual([]);
    await panelOf(page).getByRole('button', { name: 'As YAML' }).click();
    expect(await violations()).toEqual([]);
  });
});
