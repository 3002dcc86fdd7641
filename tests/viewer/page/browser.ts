// SPDX-License-Identifier: Apache-2.0
// A browser, the page and an imagined memory, as a person has them. Every test ends by looking
// whether the page asked another host, broke its policy or threw something.
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { chromium, type Browser, type BrowserContext, type Page } from 'playwright-core';
import { afterAll, afterEach, beforeAll, expect } from 'vitest';
// @ts-expect-error The mock is plain JavaScript.
import { startMock } from '@mock/server.mjs';

export interface Answer { status: number; type: string; body: string | Uint8Array; headers: Record<string, string> }
export interface Mock {
  readonly url: string;
  readonly address: string;
  readonly state: { intercept: (url: URL) => Answer | null; delayMs: number; requests: string[] };
  readonly close: () => Promise<void>;
}

export const refusal = (status: number, code: string, message: string): Answer =>
  ({ status, type: 'application/json', headers: {}, body: JSON.stringify({ error: { code, message } }) });
export const json = (value: unknown): Answer => ({ status: 200, type: 'application/json', headers: {}, body: JSON.stringify(value) });

const executable = process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);

export interface Visit {
  readonly page: Page;
  readonly mock: Mock;
  readonly context: BrowserContext;
}

let browser: Browser;
let mock: Mock;
let contexts: BrowserContext[] = [];
let faults: string[] = [];

/** Starts a browser for the tests of a file. */
export function useBrowser(): void {
  beforeAll(async () => {
    browser = await chromium.launch({ executablePath: executable, args: ['--no-sandbox', '--enable-unsafe-swiftshader'] });
  });
  afterAll(async () => browser?.close());
  afterEach(async () => {
    await Promise.all(contexts.map((context) => context.close()));
    contexts = [];
    await mock?.close();
    const found = faults;
    faults = [];
    expect(found).toEqual([]);
  });
}

export interface VisitOptions {
  readonly hash?: string;
  readonly size?: { width: number; height: number };
  readonly scheme?: 'light' | 'dark';
  readonly still?: boolean;
  /** Errors that the browser writes and that are meant to happen. */
  readonly expected?: RegExp;
  readonly intercept?: (url: URL) => Answer | null;
  readonly ready?: boolean;
  /** What a running `engram view` printed; otherwise the imagined memory is visited. */
  readonly url?: string;
}

/** A running gateway in the place of the imagined one. */
const running = (url: string): Mock => ({
  url, address: new URL(url).origin, state: { intercept: () => null, delayMs: 0, requests: [] }, close: async () => undefined,
});

/** Opens the page as `engram view` would, and waits until its panels are there. */
export async function visit(options: VisitOptions = {}): Promise<Visit> {
  mock = options.url ? running(options.url) : ((await startMock()) as Mock);
  if (options.intercept) mock.state.intercept = options.intercept;
  const context = await browser.newContext({
    viewport: options.size ?? { width: 1440, height: 900 }, colorScheme: options.scheme ?? 'light', reducedMotion: options.still ? 'reduce' : 'no-preference',
    permissions: ['clipboard-read', 'clipboard-write'], acceptDownloads: true,
  });
  contexts.push(context);
  const page = await context.newPage();
  page.setDefaultTimeout(20_000);
  const host = new URL(mock.address).host;
  page.on('request', (request) => {
    const url = new URL(request.url());
    if (/^(https?|wss?):$/.test(url.protocol) && url.host !== host) faults.push(`asked another host: ${request.url()}`);
  });
  page.on('websocket', (socket) => { if (new URL(socket.url()).host !== host) faults.push(`asked another host: ${socket.url()}`); });
  page.on('pageerror', (error) => faults.push(`threw: ${error.message}`));
  page.on('console', (message) => {
    if (message.type() === 'error' && !options.expected?.test(message.text())) faults.push(`wrote: ${message.text()}`);
  });
  await page.goto(mock.url + (options.hash ?? ''));
  if (options.ready !== false) {
    await page.getByRole('slider', { name: 'Cursor in time' }).waitFor();
    await page.getByLabel(/^Inspector/).locator('.facts').first().waitFor();
  }
  return { page, mock, context };
}

/** The chosen time, in nanoseconds, as the address has it. */
export async function cursorOf(page: Page): Promise<bigint> {
  await page.waitForTimeout(260);
  const text = /t=([0-9a-z]+)/.exec(new URL(page.url()).hash)?.[1] ?? '0';
  return [...text].reduce((value, c) => value * 36n + BigInt(Number.parseInt(c, 36)), 0n);
}

/** What is on the screen, in nanoseconds. */
export async function viewOf(page: Page): Promise<{ from: bigint; length: bigint }> {
  await page.waitForTimeout(260);
  const [from, length] = (/v=([0-9a-z]+)\.([0-9a-z]+)/.exec(new URL(page.url()).hash)?.slice(1) ?? ['0', '0'])
    .map((text) => [...text].reduce((value, c) => value * 36n + BigInt(Number.parseInt(c, 36)), 0n));
  return { from: from!, length: length! };
}

export const kStart = 1767250800000000000n;
export const clockTime = (page: Page) => page.locator('.clock');

export async function goTo(page: Page, time: string): Promise<void> {
  await page.keyboard.press('g');
  await page.getByRole('textbox', { name: 'Time' }).fill(time);
  await page.keyboard.press('Enter');
}

export async function choose(page: Page, name: string): Promise<void> {
  await page.keyboard.press('/');
  await page.getByLabel('Name of an entity').fill(name);
  await page.keyboard.press('Enter');
}

/** The colours that a canvas has, as a set of "r,g,b" of its opaque pixels. */
export const coloursOf = (page: Page, selector: string): Promise<string[]> =>
  page.locator(selector).first().evaluate((element) => {
    const canvas = element as HTMLCanvasElement;
    const { data } = canvas.getContext('2d')!.getImageData(0, 0, canvas.width, canvas.height);
    const found = new Set<string>();
    for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 250) found.add(`${data[i]},${data[i + 1]},${data[i + 2]}`);
    return [...found];
  });

/** How many pixels of the scene are nearly of a colour. */
export const pixelsOf = (page: Page, wanted: readonly [number, number, number]) => page.locator('.scene canvas').evaluate((element, [r, g, b]) => {
  const source = element as HTMLCanvasElement;
  const copy = new OffscreenCanvas(source.width, source.height);
  const context = copy.getContext('2d')!;
  context.drawImage(source, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 60 && Math.abs(data[i]! - r!) + Math.abs(data[i + 1]! - g!) + Math.abs(data[i + 2]! - b!) < 60) count += 1;
  return count;
}, wanted);

/** Of the folder in which the tests are run, which has the libraries of the page. */
export const axeSource = (): string => readFileSync(createRequire(`${process.cwd()}/package.json`).resolve('axe-core/axe.min.js'), 'utf8');
