// SPDX-License-Identifier: Apache-2.0
import { createSignal, For, Show } from 'solid-js';
import { copyLink, goFirst, goLast, stepBy } from '../state/actions';
import { isConnected, isFollowing, setFollowing } from '../state/live';
import { isPlaying, kSpeeds, setSpeed, speed, togglePlay } from '../state/play';
import { cursor, entities, info, isFuture, last, nodeOf, openPanel, selected, setCursor } from '../state/store';
import { askedMemory } from '../api/client';
import { isImage } from '../api/types';
import { memories, showMemory, type KnownMemory } from '../state/start';
import type { PanelKind } from '../state/url';
import { formatClock, formatCount, formatDate, formatDuration } from '../time/format';
import { Icon, IconButton, type IconName } from './Icon';

const kPanels: readonly { kind: PanelKind; icon: IconName; title: string; ofEntity: boolean }[] = [
  { kind: 'images', icon: 'image', title: 'Images', ofEntity: true },
  { kind: 'plot', icon: 'chart-line', title: 'Plot', ofEntity: true },
  { kind: 'similar', icon: 'sparkles', title: 'Similar moments', ofEntity: true },
  { kind: 'map', icon: 'chart-scatter', title: 'Memory map', ofEntity: true },
  { kind: 'inspector', icon: 'list-tree', title: 'Inspector', ofEntity: false },
  { kind: 'scene', icon: 'box', title: '3-D scene', ofEntity: false },
  { kind: 'nights', icon: 'moon', title: 'Nights and bytes', ofEntity: false },
  { kind: 'ask', icon: 'message', title: 'Ask', ofEntity: false },
  { kind: 'query', icon: 'terminal', title: 'Query', ofEntity: false },
];

const counted = (count: number | undefined, of: string): string => (count === undefined ? '' : `${formatCount(count)} ${of}`);

/** Stores of one name are told apart by their paths. */
const nameOf = (one: KnownMemory): string => (memories().filter((other) => other.name === one.name).length > 1 ? one.path ?? one.name : one.name);

export function Header(props: { onDialog: (dialog: 'search' | 'help' | 'time') => void }) {
  return (
    <header class="top">
      <h1><svg class="logo" viewBox="0 0 32 32" aria-hidden="true"><rect width="32" height="32" rx="7" class="logo-back" /><path d="M6 10h13M6 16h9M6 22h11" class="logo-past" /><path d="M23 10h3M19.5 16h3M21.5 22h3" class="logo-next" /></svg>Engram</h1>
      <span class="store" title={info()?.stores.map((store) => store.path ?? store.name).join('\n')}>
        <Show when={memories().length > 1} fallback={info()?.stores.map((store) => store.name).join(' + ')}>
          <select aria-label="Memory" value={String(askedMemory())} onChange={(event) => showMemory(Number(event.currentTarget.value))}>
            <For each={memories()}>{(one, i) => <option value={String(i())} title={one.path ?? one.name}>{nameOf(one)}</option>}</For>
          </select>
        </Show>
        <small>{[counted(info()?.entities, 'entities'), counted(info()?.snapshots, 'snapshots')].filter((part) => part !== '').join(' · ')}</small></span>
      <div class="transport" role="group" aria-label="Time">
        <IconButton icon="skip-back" label="First snapshot" onClick={goFirst} />
        <IconButton icon="step-back" label="Previous snapshot of the chosen entity" onClick={() => void stepBy(-1)} />
        <IconButton icon={isPlaying() ? 'pause' : 'play'} label={isPlaying() ? 'Pause' : 'Play'} onClick={togglePlay} />
        <IconButton icon="step-forward" label="Next snapshot of the chosen entity" onClick={() => void stepBy(1)} />
        <IconButton icon="skip-forward" label="Last snapshot" onClick={goLast} />
        <select aria-label="Speed" value={String(speed())} onChange={(event) => setSpeed(Number(event.currentTarget.value))}>
          <For each={kSpeeds}>{(value) => <option value={String(value)}>{value}×</option>}</For>
        </select>
      </div>
      <button class="clock" classList={{ future: isFuture() }} onClick={() => props.onDialog('time')} title="Go to a time (g)">
        <span class="unseen">Cursor at </span>
        <span class="date">{formatDate(cursor())}</span><span class="time">{formatClock(cursor(), 6)}</span><span class="nano">{formatClock(cursor(), 9).slice(15)}</span>
        <span class="when">{isFuture() ? `+${formatDuration(cursor() - last())}` : cursor() === last() ? 'last' : `−${formatDuration(last() - cursor())}`}</span>
      </button>
      <Show when={info()?.is_live}>
        <button class="live" classList={{ on: isFollowing() }} aria-pressed={isFollowing()} onClick={() => { setCursor(last()); setFollowing(!isFollowing()); }}><Icon name="radio" />{isConnected() ? (isFollowing() ? 'Live' : 'Follow') : 'No connection'}</button>
      </Show>
      <span class="spring" />
      <AddPanel />
      <IconButton icon="search" label="Search entities (/)" onClick={() => props.onDialog('search')} />
      <IconButton icon="link" label="Copy a link to this view (l)" onClick={() => void copyLink()} />
      <IconButton icon="help" label="Help (?)" onClick={() => props.onDialog('help')} />
    </header>
  );
}

function AddPanel() {
  const [isOpen, setOpen] = createSignal(false);
  let menu!: HTMLDivElement;
  const add = (kind: PanelKind, ofEntity: boolean) => {
    setOpen(false);
    const entity = ofEntity ? selected() || entities()[0]?.id || '' : '';
    openPanel(kind, entity);
  };
  const usable = (kind: PanelKind) => { const kinds = nodeOf(selected())?.kinds; return kinds === undefined || (kind === 'images' ? isImage(kinds) : kind === 'plot' ? kinds.includes('number') : true); };
  return (
    <div class="menu" ref={menu} onFocusOut={(event) => { if (!menu.contains(event.relatedTarget as Node | null)) setOpen(false); }} onKeyDown={(event) => { if (event.key === 'Escape') setOpen(false); }}>
      <button class="with-icon" aria-haspopup="true" aria-expanded={isOpen()} onClick={() => setOpen(!isOpen())}><Icon name="plus" /> Panel</button>
      <Show when={isOpen()}>
        <div class="menu-list" role="group" aria-label="Panels">
          <For each={kPanels}>{(one) => <button disabled={one.ofEntity && !usable(one.kind)} onClick={() => add(one.kind, one.ofEntity)}><Icon name={one.icon} />{one.title}</button>}</For>
        </div>
      </Show>
    </div>
  );
}
