// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, lazy, on, Match, onCleanup, onMount, Show, Suspense, Switch } from 'solid-js';
import { ImagesPanel } from './panels/images/ImagesPanel';
import { Inspector } from './panels/Inspector';
import { PlotPanel } from './panels/plot/PlotPanel';
import { QueryPanel } from './panels/QueryPanel';
import { SimilarPanel } from './panels/SimilarPanel';
import { watchLive } from './state/live';
import { watchMoving } from './state/moving';
import { watchPlay } from './state/play';
import { failure, isReady, isSettled, start, watchAddress } from './state/start';
import { heightOf, info, isSide, notice, panels, revealed, type Panel } from './state/store';
import { Timeline } from './timeline/Timeline';
import { HelpDialog, SearchDialog, TimeDialog } from './ui/Dialogs';
import { dropSide } from './ui/drag';
import { Header } from './ui/Header';
import { Empty } from './ui/PanelFrame';
import { keyOf } from './ui/keys';
import { keyTable } from './ui/keyTable';
import { Splitter } from './ui/Splitter';

// Who opens no 3-D panel never loads three.js, which is large; nor what else few open.
const ScenePanel = lazy(() => import('./panels/scene/ScenePanel'));
const MapPanel = lazy(() => import('./panels/map/MapPanel'));
const AskPanel = lazy(() => import('./panels/asked/AskPanel'));
const NightsPanel = lazy(() => import('./panels/nights/NightsPanel'));

function AnyPanel(props: { panel: Panel }) {
  return (
    <Switch>
      <Match when={props.panel.kind === 'images'}><ImagesPanel panel={props.panel} /></Match>
      <Match when={props.panel.kind === 'plot'}><PlotPanel panel={props.panel} /></Match>
      <Match when={props.panel.kind === 'inspector'}><Inspector panel={props.panel} /></Match>
      <Match when={props.panel.kind === 'similar'}><SimilarPanel panel={props.panel} /></Match>
      <Match when={props.panel.kind === 'nights'}><Suspense fallback={<div class="panel skeleton" />}><NightsPanel panel={props.panel} /></Suspense></Match>
      <Match when={props.panel.kind === 'query'}><QueryPanel panel={props.panel} /></Match>
      <Match when={props.panel.kind === 'ask'}><Suspense fallback={<div class="panel skeleton" />}><AskPanel panel={props.panel} /></Suspense></Match>
      <Match when={props.panel.kind === 'scene'}><Suspense fallback={<div class="panel skeleton" />}><ScenePanel panel={props.panel} /></Suspense></Match>
      <Match when={props.panel.kind === 'map'}><Suspense fallback={<div class="panel skeleton" />}><MapPanel panel={props.panel} /></Suspense></Match>
    </Switch>
  );
}

/** Panels by key, so that a changed option neither builds a panel anew nor makes others ask again. */
function Panels(props: { isSide: boolean }) {
  const keys = () => panels().filter((panel) => isSide(panel.kind) === props.isSide).map((panel) => panel.key);
  return (
    <For each={keys()}>{(key) => {
      const first = panels().find((panel) => panel.key === key)!;
      const panel = createMemo<Panel>((before) => panels().find((other) => other.key === key) ?? before, first);
      const height = () => { const given = heightOf(key); return given === undefined ? undefined : `${given}px`; };
      return <div class={`slot slot-${first.kind}`} classList={{ 'drop-before': dropSide(key) === 'before', 'drop-after': dropSide(key) === 'after', sized: height() !== undefined }} style={{ height: height(), 'min-height': height() }} data-key={key}><AnyPanel panel={panel()} /></div>;
    }}</For>
  );
}

export function App() {
  const [dialog, setDialog] = createSignal<'search' | 'help' | 'time' | ''>('');
  const table = keyTable(setDialog, () => setDialog(''));
  watchMoving();
  watchPlay();
  watchLive();
  watchAddress();
  createEffect(on(revealed, ({ key }) => {
    // The first panels come by themselves, and the page stays where it is.
    if (isSettled()) requestAnimationFrame(() => document.querySelector(`[data-key="${key}"]`)?.scrollIntoView({ block: 'nearest' }));
  }, { defer: true }));
  onMount(() => {
    void start();
    const onKey = (event: KeyboardEvent) => {
      if (dialog() !== '') return;
      const key = keyOf(table, event);
      if (!key) return;
      event.preventDefault();
      key.run(event);
    };
    addEventListener('keydown', onKey);
    onCleanup(() => removeEventListener('keydown', onKey));
  });
  const hasSide = () => panels().some((panel) => isSide(panel.kind));
  const hasMain = () => panels().some((panel) => !isSide(panel.kind));
  return (
    <Show when={!failure()} fallback={<main class="refused"><h1>Engram viewer</h1><p role="alert">{failure()}</p><button onClick={() => void start()}>Try again</button></main>}>
      <Show when={isReady()} fallback={<main class="refused"><p role="status">Opening the memory ...</p></main>}>
        <Header onDialog={setDialog} />
        <main class="main">
          <Show when={(info()?.entities ?? 0) > 0} fallback={<Empty title="This memory is empty">Record something: engram import, engram simulate kitchen, or a robot that commits to engram serve.</Empty>}>
            <Timeline />
            <Splitter />
            <div class="panels" classList={{ 'without-side': !hasSide(), 'without-main': !hasMain() }}>
              <Show when={hasMain() || !hasSide()}><div class="panels-main"><Panels isSide={false} />
                <Show when={panels().length === 0}><Empty title="No panel is open">Add one with “+ Panel”, or press i, p, s, n, q for the chosen entity.</Empty></Show></div></Show>
              <Show when={hasSide()}><aside class="panels-side" aria-label="Details"><Panels isSide={true} /></aside></Show>
            </div>
          </Show>
        </main>
      </Show>
      <div class="notice" role="status" aria-live="polite">{notice()}</div>
      <Show when={dialog() === 'help'}><HelpDialog keys={table} onClose={() => setDialog('')} /></Show>
      <Show when={dialog() === 'search'}><SearchDialog onClose={() => setDialog('')} /></Show>
      <Show when={dialog() === 'time'}><TimeDialog onClose={() => setDialog('')} /></Show>
    </Show>
  );
}
