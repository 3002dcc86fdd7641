// SPDX-License-Identifier: Apache-2.0
// From nothing to a usable view: what the memory is, what it holds, and which panels suit it.
import { batch, createEffect, createSignal } from 'solid-js';
import { ApiError, askedMemory, askMemory, getJson } from '../api/client';
import { info as infoDecoder, isImage, memories as memoriesDecoder, treeLevel, type TreeNode } from '../api/types';
import { membersOf } from './moment';
import { messageOf } from './request';
import { applyState, currentState, entities, home, info, openPanel, selected, setCursor, setInfo, setRoots, setSelected, setView } from './store';
import { decodeState, encodeState, type ViewState } from './url';

export const [failure, setFailure] = createSignal('');
export const [isReady, setReady] = createSignal(false);
/** True once the first panels are there. */
export const [isSettled, setSettled] = createSignal(false);

export interface KnownMemory { readonly name: string; readonly path?: string | undefined }
/** All that the gateway shows; the page shows one of them. */
export const [memories, setMemories] = createSignal<readonly KnownMemory[]>([]);

/** Levels that are asked for at once: all. */
const kDepth = 4;
/** Entities whose members are looked at where the tree does not tell their kinds. */
const kMaxAsked = 24;

/** The whole tree, or its first level where that is too much for an answer; the others come as they are opened. */
async function askTree(): Promise<TreeNode[]> {
  const ask = async (depth: number) => (await getJson('tree', { under: '', depth }, treeLevel)).children;
  try {
    return await ask(kDepth);
  } catch (error) {
    if (error instanceof ApiError && error.code === 'resource exhausted') return ask(1);
    throw error;
  }
}

const hasImage = (node: TreeNode): boolean => isImage(node.kinds ?? []);

/** Entities with their kinds: of a server, those of the members of the first few. */
async function knownEntities(): Promise<TreeNode[]> {
  const all = entities();
  if (all.some((node) => node.kinds !== undefined)) return all;
  return Promise.all(all.slice(0, kMaxAsked).map(async (node) => ({ ...node, kinds: (await membersOf(node.id).catch(() => [])).map((member) => member.kind) })));
}

/** The panels that a stranger wants to see first. */
async function suggestPanels(): Promise<void> {
  const all = [...(await knownEntities())].sort((a, b) => (b.snapshots ?? 0) - (a.snapshots ?? 0));
  // Colours tell a stranger more than depth does, of which there is as much.
  const camera = all.find((node) => node.kinds?.includes('image')) ?? all.find(hasImage);
  const moving = all.filter((node) => !hasImage(node) && node.kinds?.includes('number') && (node.snapshots ?? 2) > 1).slice(0, 2);
  if (selected() === '') setSelected(camera?.id ?? moving[0]?.id ?? all[0]?.id ?? '');
  if (camera) openPanel('images', camera.id);
  for (const node of moving) {
    const members = await membersOf(node.id).catch(() => []);
    const numbers = members.filter((member) => member.kind === 'number').map((member) => member.path);
    if (numbers.length > 0) openPanel('plot', node.id, numbers.slice(0, numbers.length > 8 ? 5 : 3));
  }
  openPanel('inspector', '');
  if (camera) openPanel('similar', camera.id);
}

/** Another memory may be of another day: times of which it has nothing would show nothing. */
export function withoutForeignTimes(state: ViewState, known: { first: bigint; last: bigint; max_horizon_ns: bigint }): ViewState {
  const { cursor, view, ...rest } = state;
  const isSeen = (from: bigint, to: bigint) => to >= known.first && from <= known.last + known.max_horizon_ns;
  return { ...rest, ...(cursor !== undefined && isSeen(cursor, cursor) ? { cursor } : {}), ...(view && isSeen(view.from, view.to) ? { view } : {}) };
}

/** Shows another memory at the same time and with the same panels, as far as it has them. */
export function showMemory(number: number): void {
  const { memory: _, ...state } = currentState();
  location.hash = encodeState(number > 0 ? { ...state, memory: number } : state);
}

export async function start(): Promise<void> {
  setFailure('');
  try {
    const address: ViewState = decodeState(location.hash);
    askMemory(address.memory ?? 0);
    const [all, known, tree] = await Promise.all([getJson('memories', {}, memoriesDecoder), getJson('info', {}, infoDecoder), askTree()]);
    setMemories(all.memories);
    const state = all.memories.length > 1 ? withoutForeignTimes(address, known) : address;
    batch(() => {
      setInfo(known);
      setRoots(tree);
      setView(home());
      setCursor(known.last, false);
      applyState(state);
    });
    setReady(true);
    document.title = `${known.stores[0]?.name ?? 'Engram'} – Engram viewer`;
    if (!state.panels) await suggestPanels();
    setSettled(true);
  } catch (error) {
    setFailure(messageOf(error));
  }
}

/** Keeps the address as the view is; replaced, not added, so that "back" leaves the page. */
export function watchAddress(): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let mine = '';
  createEffect(() => {
    if (!isReady()) return;
    const hash = encodeState(currentState());
    clearTimeout(timer);
    // Browsers allow some 200 changes of the address in 30 s.
    timer = setTimeout(() => { mine = hash; history.replaceState(null, '', hash); }, 180);
  });
  addEventListener('hashchange', () => {
    // What is known of the one memory says nothing of the other: the page begins anew.
    if ((decodeState(location.hash).memory ?? 0) !== askedMemory()) return location.reload();
    if (location.hash !== mine && info()) applyState(decodeState(location.hash));
  });
}
