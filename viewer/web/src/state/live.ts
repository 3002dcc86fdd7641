// SPDX-License-Identifier: Apache-2.0
// Follows a server as it records. Frames of commits move the end of time; nothing is asked for them
// but what is on the screen.
import { batch, createEffect, createSignal, on, onCleanup, untrack } from 'solid-js';
import { askedMemory } from '../api/client';
import { liveFrame } from '../api/types';
import { parseId } from './ids';
import { cursor, info, last, noteGap, say, setCursor, setLiveLast, setLiveLasts } from './store';

export const [isFollowing, setFollowing] = createSignal(false);
export const [isConnected, setConnected] = createSignal(false);

export interface Frame {
  readonly newest?: bigint;
  /** The newest time of each entity. */
  readonly ofEach: ReadonlyMap<string, bigint>;
  readonly dropped: number;
  readonly message?: string;
}

const kNothing: Frame = { ofEach: new Map(), dropped: 0 };

/** The newest times that a frame tells, if any. */
export function newestOf(text: string): Frame {
  let frame;
  try {
    frame = liveFrame(JSON.parse(text), '');
  } catch {
    return kNothing; // A frame that cannot be read changes nothing.
  }
  if (frame.memory !== askedMemory()) return kNothing;
  if (frame.kind === 'interrupted') return { ...kNothing, message: frame.message || 'The server was lost for a while.' };
  if (frame.kind === 'dropped') return { ...kNothing, dropped: frame.count };
  let newest: bigint | undefined;
  const ofEach = new Map<string, bigint>();
  for (const id of frame.ids) {
    const { entity, time } = parseId(id);
    if (time === undefined) continue;
    if (newest === undefined || time > newest) newest = time;
    if (time > (ofEach.get(entity) ?? time - 1n)) ofEach.set(entity, time);
  }
  return { newest, ofEach, dropped: 0 };
}

/** Call once, below a root of Solid. */
export function watchLive(): void {
  let expected: bigint | null = null;
  createEffect(() => {
    if (!info()?.is_live) return;
    let socket: WebSocket | undefined;
    let timer: ReturnType<typeof setTimeout> | undefined;
    let pending: bigint | undefined;
    const pendingOfEach = new Map<string, bigint>();
    let frame = 0;
    const show = (): void => {
      frame = 0;
      batch(() => {
        if (pendingOfEach.size > 0) setLiveLasts(pendingOfEach);
        pendingOfEach.clear();
        if (pending === undefined || pending <= last()) return;
        setLiveLast(pending);
        if (isFollowing()) { expected = pending; setCursor(pending); }
      });
    };
    const connect = (): void => {
      socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/api/live`);
      socket.onopen = () => setConnected(true);
      socket.onclose = () => { setConnected(false); noteGap(); timer = setTimeout(connect, 2000); };
      socket.onmessage = (event) => {
        const { newest, ofEach, dropped, message } = newestOf(String(event.data));
        if (message || dropped > 0) noteGap();
        if (message) say(message);
        if (dropped > 0) say(`The gateway was too busy to tell of ${dropped} commits; the timeline shows them when it asks next.`);
        if (newest !== undefined && (pending === undefined || newest > pending)) pending = newest;
        for (const [entity, time] of ofEach) if (time > (pendingOfEach.get(entity) ?? time - 1n)) pendingOfEach.set(entity, time);
        frame ||= requestAnimationFrame(show);
      };
    };
    connect();
    // A link to a moment of the past shows that moment, whatever is committed meanwhile.
    expected = untrack(cursor);
    setFollowing(expected >= untrack(last));
    onCleanup(() => { clearTimeout(timer); cancelAnimationFrame(frame); if (socket) { socket.onclose = null; socket.close(); } });
  });
  // Who moves the cursor wants to look at something: following pauses.
  createEffect(on(cursor, (at) => { if (isFollowing() && expected !== null && at !== expected) setFollowing(false); }, { defer: true }));
}
