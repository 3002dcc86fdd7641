// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, onCleanup, onMount, Show } from 'solid-js';
import { getJson } from '../../api/client';
import { Turns } from '../../api/turns';
import { moment as momentDecoder } from '../../api/types';
import { shortName } from '../../state/ids';
import { isPredicted } from '../../state/moment';
import { createRequest } from '../../state/request';
import { cursor, entities, selected, setSelected, type Panel } from '../../state/store';
import { formatNumber } from '../../time/format';
import { download } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import { createSize } from '../../ui/size';
import { theme } from '../../ui/theme';
import { posesIn, type Placed } from './poses';
import { createWorld, type Anchor, type Thing, type World } from './world';

const kMaxEntities = 64;
const turns = new Turns(4);

interface Found {
  readonly id: string;
  readonly source: string;
  readonly places: readonly Placed[];
}

/** Everything that has a place at the cursor; what is predicted is drawn as a ghost. */
export default function ScenePanel(props: { panel: Panel }) {
  const [size, sizeRef] = createSize();
  const [anchors, setAnchors] = createSignal<readonly Anchor[]>([]);
  const [problem, setProblem] = createSignal('');
  const placeable = createMemo(() => entities().filter((node) => !node.kinds || node.kinds.includes('pose') || (node.kinds.includes('number') && /platform|localization|base/i.test(node.id))).map((node) => node.id).slice(0, kMaxEntities));
  const found = createRequest<Found[]>(() => {
    const at = cursor();
    const ids = placeable();
    if (ids.length === 0) return null;
    return {
      group: 'scene',
      run: async (signal) => {
        const ask = (id: string) => turns.run(async () => {
          const here = await getJson('moment', { entity: id, at, which: isPredicted(id, at) ? 'predict' : 'at-or-before' }, momentDecoder, signal);
          return { id, source: here.source, places: posesIn(here.instances[0]?.data) };
        }, signal);
        // An entity that was not there yet is no error of the scene.
        const all = await Promise.all(ids.map((id) => ask(id).catch((error: unknown) => { if (signal.aborted) throw error; return null; })));
        return all.filter((one) => one !== null);
      },
    };
  });
  const things = createMemo<Thing[]>(() => (found.data() ?? []).flatMap((one) => one.places.map((placed) => ({ id: one.id, label: shortName(one.id), placed, isPredicted: one.source === 'predicted', isChosen: one.id === selected() }))));
  let host!: HTMLDivElement;
  let world: World | undefined;
  onMount(() => {
    try {
      world = createWorld(setAnchors);
      host.prepend(world.canvas);
      world.canvas.setAttribute('aria-hidden', 'true');
    } catch {
      setProblem('This browser gives no WebGL, so the scene is shown as a table.');
    }
    onCleanup(() => world?.dispose());
    createEffect(() => { const { width, height } = size(); if (width > 0) world?.resize(width, height); });
    createEffect(() => world?.show(things(), theme()));
  });
  const [isTable, setTable] = createSignal(false);
  return (
    <PanelFrame panel={props.panel} icon="box" title="3-D scene" isBusy={found.isBusy()} error={problem() || found.error()}
      actions={<>
        <IconButton icon="table" label="Show places as a table" isPressed={isTable()} onClick={() => setTable(!isTable())} />
        <IconButton icon="download" label="Save the scene as PNG" onClick={() => { if (world) void download(world.canvas, 'scene.png'); }} />
      </>}>
      <Show when={placeable().length === 0}><Empty title="Nothing has a place">Poses are dicts of a position and an orientation; no entity here has one.</Empty></Show>
      {/* Always there, because three.js draws into it; entities may come later. */}
      <div class="scene" hidden={isTable() || problem() !== '' || placeable().length === 0} ref={(element) => { host = element; sizeRef(element); }} role="img" aria-label={`Scene with ${things().length} things; shown as a table on request`}>
        <For each={anchors()}>{(anchor) => <span class="scene-label" style={{ transform: `translate(${Math.round(anchor.x)}px, ${Math.round(anchor.y)}px) translate(-50%, -100%)` }}>{anchor.label}</span>}</For>
      </div>
      <Show when={placeable().length > 0 && (isTable() || problem() !== '')}>
        <div class="series-table" tabindex="0" role="region" aria-label="Places">
          <table><thead><tr><th scope="col">entity</th><th scope="col">x m</th><th scope="col">y m</th><th scope="col">z m</th><th scope="col">frame</th></tr></thead>
            <tbody><For each={things()}>{(thing) => <tr><th scope="row"><button onClick={() => setSelected(thing.id)}>{thing.id}</button></th>
              <For each={thing.placed.position}>{(value) => <td>{formatNumber(Math.round(value * 1e4) / 1e4)}</td>}</For><td>{/(?:^|\/)pose_([^_/]+)_/.exec(thing.placed.path)?.[1] ?? ''}</td></tr>}</For></tbody></table>
        </div>
      </Show>
    </PanelFrame>
  );
}
