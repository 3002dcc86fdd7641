// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, onCleanup, onMount, Show } from 'solid-js';
import type { Object3D } from 'three';
import { shortName } from '../../state/ids';
import { isPredicted } from '../../state/moment';
import { createRequest } from '../../state/request';
import { cursor, selected, setOption, setSelected, type Panel } from '../../state/store';
import { formatNumber } from '../../time/format';
import { download } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import { createSize } from '../../ui/size';
import { theme } from '../../ui/theme';
import { createClouds } from './clouds';
import { cloudObject } from './pointCloud';
import { createNavigation } from './navigation';
import { frameOfPath, isInWorld, type Placed } from './poses';
import { createSources, type Found } from './sources';
import { createStanding } from './stand';
import { createViews } from './views';
import { createWorld, type Anchor, type Thing, type World } from './world';

const kHorizons = [['0', 'off'], ['200000000', '+200 ms'], ['400000000', '+400 ms'], ['1000000000', '+1 s']] as const;
interface Seen extends Found {
  readonly places: readonly Placed[];
}
const metres = (value: number): string => formatNumber(Math.round(value * 1e4) / 1e4);

/** Everything that has a place at the cursor; what is predicted is drawn as a ghost. */
export default function ScenePanel(props: { panel: Panel }) {
  const [size, sizeRef] = createSize();
  const [anchors, setAnchors] = createSignal<readonly Anchor[]>([]);
  const [problem, setProblem] = createSignal('');
  const [world, setWorld] = createSignal<World>();
  const option = (key: string, otherwise: string) => props.panel.options[key] ?? otherwise;
  const isOn = (key: string) => option(key, '1') === '1';
  const ahead = () => BigInt(kHorizons.some(([value]) => value === option('h', '0')) ? option('h', '0') : '0');
  const sources = createSources();
  const withPlaces = (all: readonly Found[], signal: AbortSignal): Promise<Seen[]> => Promise.all(all.map(async (one) => ({ ...one, places: await sources.placesOf(one, signal) })));
  const placeable = createMemo(() => sources.idsOf('place'));
  const standing = createStanding(sources, ahead, (robot, ghost) => {
    world()?.setPart('robot', robot?.object ?? null, true);
    world()?.setPart('ghost', ghost?.object ?? null, true);
  });
  // Behind the robot, whose predictions come first then.
  const found = createRequest<Seen[]>(() => {
    if (placeable().length === 0) return null;
    const ask = sources.ask(placeable(), cursor(), () => 'at-or-before');
    return { group: 'scene', run: async (signal) => withPlaces(await ask(signal), signal) };
  });
  // What was recorded last stands there until a prediction comes, which may have to learn first.
  const foreseen = createRequest<Seen[]>(() => {
    const at = cursor();
    const ids = placeable().filter((id) => isPredicted(id, at) && sources.isQuickToPredict(id));
    if (ids.length === 0) return null;
    const ask = sources.ask(ids, at, () => 'predict');
    return { group: 'foreseen', run: async (signal) => withPlaces(await ask(signal), signal) };
  });
  /** Puts objects into the scene, in the place of those before. */
  const shower = (kind: string) => {
    let count = 0;
    return (objects: readonly Object3D[]) => {
      const made = world();
      for (let i = objects.length; i < count; ++i) made?.setPart(`${kind} ${i}`, null);
      objects.forEach((object, i) => made?.setPart(`${kind} ${i}`, object));
      count = objects.length;
    };
  };
  const showClouds = shower('cloud');
  const clouds = createClouds(sources, () => isOn('p'), (all) => { const { accent, faint } = theme(); showClouds(all.map((cloud) => cloudObject(cloud, accent, faint))); });
  const showFloor = { map: shower('map'), plan: shower('plan') };
  const navigation = createNavigation(sources, { map: () => isOn('c'), plans: () => isOn('w'), places: () => isOn('l') }, (kind, objects) => showFloor[kind](objects));
  // The picture is fitted to what comes first, and that shall not be the flags alone.
  const flags = () => (found.data() === undefined && placeable().length > 0 ? [] : navigation.flags()).map(({ id, name, pose: [x, y, heading] }): Thing => ({
    id, label: name, isPredicted: false, isChosen: id === selected(), isFlag: true,
    placed: { path: 'pose_world_location', position: [x, y, 0], orientation: [Math.cos(heading / 2), 0, 0, Math.sin(heading / 2)], isCamera: false },
  }));
  const newest = createMemo<Seen[]>(() => {
    const next = new Map((foreseen.data() ?? []).map((one) => [one.id, one]));
    return (found.data() ?? []).map((one) => next.get(one.id) ?? one);
  });
  createViews(newest, shower('view'));
  const things = createMemo<Thing[]>(() => newest().flatMap((one) => one.places.map((placed) => ({ id: one.id, label: shortName(one.id), placed, isPredicted: one.moment.source === 'predicted', isChosen: one.id === selected() }))).concat(flags()));
  const isEmpty = () => placeable().length === 0 && !standing.isThere() && !clouds.isPossible() && !navigation.isThere();
  let host!: HTMLDivElement;
  onMount(() => {
    try {
      const made = createWorld(setAnchors);
      host.prepend(made.canvas);
      made.canvas.setAttribute('aria-hidden', 'true');
      setWorld(made);
      onCleanup(() => { setWorld(undefined); made.dispose(); });
    } catch {
      setProblem('This browser gives no WebGL, so the scene is shown as a table.');
    }
    createEffect(() => { const { width, height } = size(); if (width > 0) world()?.resize(width, height); });
    createEffect(() => world()?.show(things().filter((thing) => isInWorld(thing.placed)), theme()));
  });
  const [isTable, setTable] = createSignal(false);
  const isShownAsTable = () => isTable() || problem() !== '';
  const notes = () => [...standing.notes(), ...clouds.notes(), ...navigation.notes()];
  const toggles = () => ([['p', 'points', clouds.isPossible()], ['c', 'cost map', navigation.hasMaps()], ['w', 'plan', navigation.hasPlans()], ['l', 'places', navigation.hasPlaces()]] as const).filter(([, , isThere]) => isThere);
  return (
    <PanelFrame panel={props.panel} icon="box" title="3-D scene" isBusy={found.isBusy() || foreseen.isBusy() || standing.isBusy() || clouds.isBusy() || navigation.isBusy()} error={problem() || found.error()}
      actions={<>
        <IconButton icon="table" label="Show places as a table" isPressed={isTable()} onClick={() => setTable(!isTable())} />
        <IconButton icon="download" label="Save the scene as PNG" onClick={() => { const made = world(); if (made) void download(made.canvas, 'scene.png'); }} />
      </>}>
      <Show when={isEmpty()}><Empty title="Nothing has a place">Poses are dicts of a position and an orientation; no entity here has one.</Empty></Show>
      <Show when={standing.isThere() || toggles().length > 0}>
        <div class="bar">
          <Show when={standing.isThere()}>
            <label class="field">predict ahead
              <select onChange={(event) => setOption(props.panel, 'h', event.currentTarget.value)}>
                <For each={kHorizons}>{([value, label]) => <option value={value} selected={option('h', '0') === value}>{label}</option>}</For>
              </select>
            </label>
          </Show>
          <For each={toggles()}>{([key, label]) => <label class="field"><input type="checkbox" checked={isOn(key)} onChange={(event) => setOption(props.panel, key, event.currentTarget.checked ? '1' : '0')} />{label}</label>}</For>
          <Show when={navigation.hasMaps() && isOn('c')}><CostLegend /></Show>
        </div>
      </Show>
      {/* Always there, because three.js draws into it; entities may come later. */}
      <div class="scene" hidden={isShownAsTable() || isEmpty()} ref={(element) => { host = element; sizeRef(element); }} role="img" aria-label={`Scene with ${things().length} things${standing.links().length > 0 ? ' and a robot' : ''}; shown as a table on request`}>
        <For each={anchors()}>{(anchor) => <span class="scene-label" style={{ transform: `translate(${Math.round(anchor.x)}px, ${Math.round(anchor.y)}px) translate(-50%, -100%)` }}>{anchor.label}</span>}</For>
      </div>
      <Show when={!isEmpty() && isShownAsTable()}>
        <div class="series-table" tabindex="0" role="region" aria-label="Places">
          <table><thead><tr><th scope="col">entity</th><th scope="col">x m</th><th scope="col">y m</th><th scope="col">z m</th><th scope="col">frame</th></tr></thead>
            <tbody>
              <For each={things()}>{(thing) => <tr><th scope="row"><button onClick={() => setSelected(thing.id)}>{thing.id}</button></th>
                <For each={thing.placed.position}>{(value) => <td>{metres(value)}</td>}</For><td>{frameOfPath(thing.placed.path)}</td></tr>}</For>
              <For each={standing.links()}>{(link) => <tr><th scope="row">{link.name}{link.isPredicted ? ', predicted' : ''}</th>
                <For each={link.position}>{(value) => <td>{metres(value)}</td>}</For><td>world</td></tr>}</For>
            </tbody></table>
        </div>
      </Show>
      <Show when={notes().length > 0}><ul class="scene-notes" aria-label="Notes on the scene"><For each={notes()}>{(note) => <li>{note}</li>}</For></ul></Show>
    </PanelFrame>
  );
}

/** The colours of costs, as RViz has them. */
function CostLegend() {
  return (
    <span class="legend costs" aria-label="Colours of the cost map">
      <For each={[['near', 'near an obstacle'], ['touch', 'the robot would touch'], ['obstacle', 'obstacle'], ['unknown', 'unknown']] as const}>{([name, what]) => <span class="key"><i class={`cost-${name}`} />{what}</span>}</For>
    </span>
  );
}
