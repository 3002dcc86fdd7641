// SPDX-License-Identifier: Apache-2.0
// The whole view as a short text behind '#', so that a copied link shows the same elsewhere.
//
// Form, version 1: `#1&m=MEMORY&t=CURSOR&v=FROM.LENGTH&r=FROM.LENGTH&s=ENTITY&c=ID,ID&h=HEIGHT&p=PANEL;PANEL`; times are
// base 36; a panel is `kind~entity~path,path~key.value,key.value`, and `.` the path of a whole value; its key `height` and `h` of the timeline are in pixels. What cannot be read is left out,
// so that a link of another version still opens.
import type { Span } from '../time/span';

export const kPanelKinds = ['images', 'plot', 'inspector', 'similar', 'nights', 'query', 'ask', 'scene', 'map'] as const;
export type PanelKind = (typeof kPanelKinds)[number];

export interface PanelState {
  readonly kind: PanelKind;
  readonly entity: string;
  readonly paths: readonly string[];
  readonly options: Readonly<Record<string, string>>;
  /** In pixels; absent where it is automatic. */
  readonly height?: number;
}

export interface ViewState {
  /** Which of the gateway's memories; absent for the first. */
  readonly memory?: number;
  readonly cursor?: bigint;
  readonly view?: Span;
  readonly selection?: Span;
  readonly selected?: string;
  readonly collapsed?: readonly string[];
  readonly panels?: readonly PanelState[];
  /** Height of the timeline in pixels; absent where it is automatic. */
  readonly timeline?: number;
}

/** The path of a value that is a number or an image itself is empty, which a list cannot hold. */
const kWhole = '.';

/** Keeps '/' readable; everything that separates parts is escaped. */
const escape = (text: string): string => encodeURIComponent(text).replace(/~/g, '%7E').replace(/\./g, '%2E').replace(/%2F/g, '/');

function unescape(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return '';
  }
}

const timeText = (time: bigint): string => time.toString(36);

function readTime(text: string | undefined): bigint | undefined {
  if (!text || !/^-?[0-9a-z]{1,13}$/.test(text)) return undefined;
  let value = 0n;
  for (const c of text.replace('-', '')) value = value * 36n + BigInt(Number.parseInt(c, 36));
  const signed = text.startsWith('-') ? -value : value;
  return BigInt.asIntN(64, signed) === signed ? signed : undefined;
}

const spanText = (span: Span): string => `${timeText(span.from)}.${timeText(span.to - span.from)}`;

function readSpan(text: string | undefined): Span | undefined {
  const [from, length] = (text ?? '').split('.').map(readTime);
  return from !== undefined && length !== undefined && length > 0n ? { from, to: from + length } : undefined;
}

const kHeight = 'height';
const readHeight = (text: string | undefined): number | undefined => (text !== undefined && /^\d{1,4}$/.test(text) ? Number(text) : undefined);

function panelText(panel: PanelState): string {
  const options = Object.entries({ ...panel.options, ...(panel.height === undefined ? {} : { [kHeight]: String(panel.height) }) }).map(([key, value]) => `${escape(key)}.${escape(value)}`);
  const parts = [panel.kind, escape(panel.entity), panel.paths.map((path) => escape(path) || kWhole).join(','), options.join(',')];
  while (parts.length > 1 && parts[parts.length - 1] === '') parts.pop();
  return parts.join('~');
}

function readPanel(text: string): PanelState | undefined {
  const [kind, entity = '', paths = '', options = ''] = text.split('~');
  if (!kPanelKinds.includes(kind as PanelKind)) return undefined;
  const list = (joined: string) => joined.split(',').filter((part) => part !== '');
  const { [kHeight]: tall, ...own } = Object.fromEntries(list(options).map((pair) => pair.split('.')).filter((pair) => pair.length === 2).map(([key, value]) => [unescape(key!), unescape(value!)]));
  const height = readHeight(tall);
  return {
    kind: kind as PanelKind,
    entity: unescape(entity),
    paths: list(paths).slice(0, 32).map((path) => (path === kWhole ? '' : unescape(path))),
    options: own,
    ...(height === undefined ? {} : { height }),
  };
}

export function encodeState(state: ViewState): string {
  const parts = ['1'];
  if (state.memory) parts.push(`m=${state.memory}`);
  if (state.cursor !== undefined) parts.push(`t=${timeText(state.cursor)}`);
  if (state.view) parts.push(`v=${spanText(state.view)}`);
  if (state.selection) parts.push(`r=${spanText(state.selection)}`);
  if (state.selected) parts.push(`s=${escape(state.selected)}`);
  if (state.collapsed?.length) parts.push(`c=${state.collapsed.map(escape).join(',')}`);
  if (state.timeline !== undefined) parts.push(`h=${state.timeline}`);
  if (state.panels) parts.push(`p=${state.panels.map(panelText).join(';')}`);
  return `#${parts.join('&')}`;
}

export function decodeState(hash: string): ViewState {
  const [version, ...parts] = hash.replace(/^#/, '').split('&');
  if (version !== '1') return {};
  const fields = new Map(parts.map((part) => [part.slice(0, part.indexOf('=')), part.slice(part.indexOf('=') + 1)]));
  const panels = fields.get('p');
  const state: { -readonly [K in keyof ViewState]: ViewState[K] } = {};
  if (/^[1-9]\d{0,3}$/.test(fields.get('m') ?? '')) state.memory = Number(fields.get('m'));
  const cursor = readTime(fields.get('t'));
  const view = readSpan(fields.get('v'));
  const selection = readSpan(fields.get('r'));
  if (cursor !== undefined) state.cursor = cursor;
  if (view) state.view = view;
  if (selection) state.selection = selection;
  if (fields.get('s')) state.selected = unescape(fields.get('s')!);
  if (fields.get('c')) state.collapsed = fields.get('c')!.split(',').map(unescape);
  const timeline = readHeight(fields.get('h'));
  if (timeline !== undefined) state.timeline = timeline;
  if (panels !== undefined) state.panels = panels.split(';').map(readPanel).filter((panel) => panel !== undefined).slice(0, 32);
  return state;
}
