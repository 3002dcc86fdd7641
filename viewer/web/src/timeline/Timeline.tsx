// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, on, onCleanup, onMount, Show } from 'solid-js';
import { getJson } from '../api/client';
import { treeLevel } from '../api/types';
import { copyExport, follow, selectSpan } from '../state/actions';
import { selectedLinks } from '../state/links';
import { parseId } from '../state/ids';
import { messageOf } from '../state/request';
import { collapsed, cursor, hover, last, limits, marks, roots, say, selected, selection, setChildren, setCursor, setHover, setSelected, setView, toggleCollapsed, view } from '../state/store';
import { formatDuration, formatTime } from '../time/format';
import { lengthOf, pan, timeAt, zoom } from '../time/span';
import { IconButton } from '../ui/Icon';
import { createSize, perFrame } from '../ui/size';
import { sized, theme } from '../ui/theme';
import { download, downloadSvg } from '../ui/download';
import { SvgPen } from '../ui/svg';
import { createLanes } from '../skills/ask';
import { hitAt, type Hit, type LanePlace } from '../skills/draw';
import { entitiesOf, isOfSkills, laneOf, type EventLane } from '../skills/lanes';
import { OutcomeLegend } from '../skills/OutcomeLegend';
import { describeHit } from '../skills/words';
import { setClicked, setOnScreen, toldExecution } from '../state/executions';
import { createDensity, wider } from './density';
import { drawLanes, type LaneView } from './draw';
import { listen } from './gestures';
import { kRowHeight, rowsOf, visibleRows, type Row } from './layout';
import { Minimap } from './Minimap';
import { Names } from './Names';
import { drawOverlay, kAxisHeight, type Overlay } from './overlay';
import { drawTimeline, kNamesWidth } from './picture';

/** Collapses or opens a level, and asks for its children if nobody did yet. */
export async function toggleRow(row: Row): Promise<void> {
  if (row.isEntity) return;
  if (row.node.children !== undefined) return toggleCollapsed(row.id);
  try {
    setChildren(row.id, (await getJson('tree', { under: row.id }, treeLevel)).children);
  } catch (error) {
    say(messageOf(error));
  }
}

export function Timeline() {
  const [area, areaRef] = createSize();
  const [scrollTop, setScrollTop] = createSignal(0);
  let scroller!: HTMLDivElement;
  let lanesCanvas!: HTMLCanvasElement;
  let overlayCanvas!: HTMLCanvasElement;
  let surface!: HTMLDivElement;

  const rows = createMemo(() => rowsOf(roots(), collapsed()));
  const lanesHeight = () => Math.max(0, area().height - kAxisHeight);
  const shown = createMemo(() => visibleRows(rows().length, scrollTop(), lanesHeight()));
  const ids = createMemo(() => rows().slice(shown().first, shown().end).map((row) => row.id), [], { equals: (a, b) => a.join('\n') === b.join('\n') });
  const density = createDensity(ids, () => wider(view()), () => area().width * 2, 1_000_000_000n);

  const eventful = createMemo(() => rows().slice(shown().first, shown().end).map((row) => ({ id: row.id, entities: entitiesOf(row) })).filter((row) => row.entities.length > 0));
  const lanes = createLanes(createMemo(() => [...new Set(eventful().flatMap((row) => row.entities))], [], { equals: (a, b) => a.join('\n') === b.join('\n') }), view, () => area().width * 2);
  const events = createMemo<ReadonlyMap<string, EventLane>>(() => {
    const data = lanes.data();
    if (!data) return new Map();
    // Lanes with more marks than are asked for show how many there are, like those of other entities.
    const isTold = (id: string): boolean => data.snapshots.has(id) || data.executions.has(id) || data.dense.has(id);
    return new Map(eventful().filter((row) => row.entities.some(isTold)).map((row) => [row.id, laneOf(row.entities, data.snapshots, data.executions, data.dense)]));
  });
  createEffect(() => setOnScreen(lanes.data()?.executions ?? new Map()));

  const lanePlaces = createMemo(() => new Map(rows().map((row, i) => [row.id, i])));
  const linkLines = () => {
    const found = selectedLinks();
    const place = (id: string) => lanePlaces().get(parseId(id).entity);
    const y = (row: number) => kAxisHeight + (row + 0.5) * kRowHeight - scrollTop();
    const mine = found ? place(found.id) : undefined;
    const time = found ? parseId(found.id).time : undefined;
    if (!found || mine === undefined || time === undefined) return [];
    return found.ids.flatMap((id) => {
      const row = place(id);
      const to = parseId(id).time;
      return row === undefined || to === undefined ? [] : [{ fromY: y(mine), toY: y(row), from: time, to }];
    });
  };

  const laneView = (): LaneView => ({ rows: rows(), first: shown().first, scrollTop: scrollTop(), width: area().width, height: lanesHeight(), span: view(), last: last(), selected: selected(), densities: density.data(), events: events(), execution: toldExecution() });
  const overlay = (): Overlay => ({ span: view(), ...area(), cursor: cursor(), hover: hover(), selection: selection(), last: last(), marks: marks(), links: linkLines() });
  const paintLanes = perFrame(() => {
    const { width } = area();
    const height = lanesHeight();
    if (width === 0) return;
    drawLanes(sized(lanesCanvas, width, height), laneView(), theme());
  });
  const paintOverlay = perFrame(() => {
    const { width, height } = area();
    if (width === 0) return;
    drawOverlay(sized(overlayCanvas, width, height), overlay(), theme());
  });
  createEffect(() => { area(); rows(); shown(); scrollTop(); view(); last(); selected(); density.data(); events(); toldExecution(); theme(); paintLanes(); });
  createEffect(() => { area(); view(); cursor(); hover(); selection(); last(); marks(); selectedLinks(); rows(); scrollTop(); theme(); paintOverlay(); });

  /** The row at a place of the surface, and the bar or mark that lies there. */
  const under = (x: number, y: number): { row: Row | undefined; hit: Hit | undefined } => {
    const index = Math.floor((y - kAxisHeight + scrollTop()) / kRowHeight);
    const row = y < kAxisHeight ? undefined : rows()[index];
    const lane = row && events().get(row.id);
    const place: LanePlace = { span: view(), width: area().width, y: index * kRowHeight - scrollTop() + kAxisHeight, height: kRowHeight - 1, last: last() };
    return { row, hit: lane && hitAt(lane, x, y, place) };
  };
  /** Chooses an execution where it was clicked, or what a mark stands for. */
  const goTo = (hit: Hit, at: bigint): void => {
    if ('mark' in hit) return follow(hit.mark.id);
    const { entity, start, end } = hit.execution;
    setSelected(entity);
    setCursor(at < start ? start : end !== undefined && at > end ? end : at, false);
    setClicked({ entity, start });
  };

  onMount(() => {
    const time = (x: number) => timeAt(Math.max(0, Math.min(area().width, x)), view(), area().width);
    onCleanup(listen(surface, {
      zoom: (x, factor) => setView(zoom(view(), x, area().width, factor, limits())),
      pan: (dx, dy) => {
        if (dx !== 0) setView(pan(view(), dx, area().width, limits()));
        scroller.scrollTop += dy;
      },
      hover: (x) => setHover(x === null ? null : time(x)),
      pick: (x, y) => {
        const { row, hit } = under(x, y);
        if (hit) return goTo(hit, time(x));
        setCursor(time(x), false);
        if (row?.isEntity) setSelected(row.id);
      },
      scrub: (x) => setCursor(time(x), false),
      select: (from, to) => selectSpan({ from: time(from), to: time(to) }),
      isScrubbing: (y) => y < kAxisHeight,
    }));
    const tell = (event: PointerEvent): void => {
      const box = surface.getBoundingClientRect();
      const { hit } = under(event.clientX - box.left, event.clientY - box.top);
      surface.title = hit && event.buttons === 0 ? describeHit(hit) : '';
    };
    surface.addEventListener('pointermove', tell);
    onCleanup(() => surface.removeEventListener('pointermove', tell));
  });

  const keepVisible = (index: number): void => {
    if (lanesHeight() === 0) return;
    const top = index * kRowHeight;
    if (top < scroller.scrollTop) scroller.scrollTop = top;
    else if (top + kRowHeight > scroller.scrollTop + lanesHeight()) scroller.scrollTop = top + kRowHeight - lanesHeight();
  };
  createEffect(on([selected, () => lanesHeight() > 0], () => { const place = lanePlaces().get(selected()); if (place !== undefined) keepVisible(place); }));

  const share = () => Math.round((Number(cursor() - limits().from) / Number(lengthOf(limits()))) * 1000) / 10;
  const savePng = () => {
    const out = document.createElement('canvas');
    drawTimeline(sized(out, kNamesWidth + area().width, area().height), laneView(), overlay(), theme());
    void download(out, 'timeline.png');
  };
  const saveSvg = () => {
    const pen = new SvgPen(kNamesWidth + area().width, area().height, `Timeline from ${formatTime(view().from)} to ${formatTime(view().to)}`);
    drawTimeline(pen, laneView(), overlay(), theme());
    downloadSvg(pen, 'timeline.svg');
  };
  return (
    <section class="timeline" aria-label="Timeline">
      <div class="timeline-corner">
        <span class="muted">{formatDuration(lengthOf(view()))} · {rows().filter((row) => row.isEntity).length} lanes</span>
        <span>
          <IconButton icon="download" label="Save the timeline as PNG" onClick={savePng} />
          <IconButton icon="pen-tool" label="Save the timeline as SVG" onClick={saveSvg} />
        </span>
      </div>
      <Minimap />
      <div class="timeline-head muted"><Show when={isOfSkills(selected())} fallback={<Legend />}><OutcomeLegend /></Show></div>
      <div class="lanes" ref={scroller} onScroll={() => setScrollTop(scroller.scrollTop)}>
        <Names rows={rows()} shown={shown()} onToggle={(row) => void toggleRow(row)} />
      </div>
      <div class="surface-wrap">
        <div class="surface" ref={(element) => { surface = element; areaRef(element); }} tabindex="0" role="slider" aria-label="Cursor in time"
          aria-valuemin="0" aria-valuemax="100" aria-valuenow={share()} aria-valuetext={formatTime(cursor())} data-testid="surface">
          <canvas class="lanes-canvas" ref={lanesCanvas} aria-hidden="true" />
          <canvas class="overlay-canvas" ref={overlayCanvas} aria-hidden="true" />
        </div>
        <Show when={density.error() || lanes.error()}>{(problem) => <p class="surface-error" role="alert">{problem()} <button onClick={() => { density.retry(); lanes.retry(); }}>Try again</button></p>}</Show>
        <Show when={selection()}>{(span) => (
          <div class="selection-bar">
            <span>{formatDuration(lengthOf(span()))} selected</span>
            <button onClick={() => void copyExport()}>Copy engram export</button>
            <button onClick={() => setView(span())}>Zoom</button>
            <IconButton icon="x" label="Clear the selection" onClick={() => selectSpan(null)} />
          </div>
        )}</Show>
      </div>
    </section>
  );
}

function Legend() {
  return (
    <span class="legend" aria-label="Colours of sources">
      <For each={['recorded', 'latent', 'augmented', 'predicted'] as const}>{(source) => <span class={`key ${source}`}><i />{source}</span>}</For>
    </span>
  );
}
