// SPDX-License-Identifier: Apache-2.0
import { createEffect, createMemo, createSignal, For, onCleanup, Show } from 'solid-js';
import { getJson } from '../../api/client';
import { isImage, memoryMap, type MemoryMap } from '../../api/types';
import { createMembers } from '../../state/moment';
import { createRequest } from '../../state/request';
import { cursor, setCursor, setHover, setOption, setSelected, type Panel } from '../../state/store';
import { formatClock, formatCount, formatNumber, formatTime } from '../../time/format';
import { download, downloadSvg } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import { createSize, perFrame } from '../../ui/size';
import { kFont, SvgPen, type Pen } from '../../ui/svg';
import { isDark, sized, theme } from '../../ui/theme';
import { Thumb } from '../images/Thumb';
import { drawLegend, drawMap, indexAt, nearestTo, placesOf, radiusFor, recordingColour, timeColour, type ColourBy, type LegendEntry, type MapView } from './draw';

const kMaxMoments = 2000;
const kMaxRows = 100;
/** Recordings that the legend names; colours come again after so many. */
const kMaxNamed = 8;

/** What a memory is like as a whole: each moment of an entity is a point, and those that are alike lie together. */
export default function MapPanel(props: { panel: Panel }) {
  const [size, sizeRef] = createSize();
  const [hovered, setHovered] = createSignal<number>();
  const entity = () => props.panel.entity;
  const members = createMembers(entity);
  const path = createMemo(() => members.data()?.find((member) => isImage(member.kind))?.path);
  const asked = createRequest<MemoryMap>(() => (entity() === '' ? null : { group: entity(), run: (signal) => getJson('map', { entity: entity(), max: kMaxMoments }, memoryMap, signal) }));
  const isTable = () => props.panel.options.table === '1';
  const colourBy = (): ColourBy => (props.panel.options.colour === 'recording' ? 'recording' : 'time');
  const map = () => { const found = asked.data(); return found && found.times.length > 0 ? found : undefined; };
  const places = createMemo(() => { const found = map(); return found && size().width > 0 ? placesOf(found, size().width, size().height) : []; });
  const pinned = createMemo(() => { const found = map(); return found ? indexAt(found.times, cursor()) : undefined; });
  createEffect(() => { asked.data(); setHovered(undefined); });
  let canvas!: HTMLCanvasElement;
  const view = (at = places()): MapView => ({ map: map()!, places: at, radius: radiusFor(at.length, size().width, size().height), colourBy: colourBy(), isDark: isDark(), pinned: pinned(), hovered: hovered() });
  const paint = perFrame(() => {
    if (places().length > 0 && map() && !isTable()) drawMap(sized(canvas, size().width, size().height), view(), theme());
  });
  createEffect(() => { places(); colourBy(); pinned(); hovered(); theme(); isTable(); paint(); });
  const point = (i: number | undefined) => {
    setHovered(i);
    setHover(i === undefined ? null : map()!.times[i]!);
  };
  onCleanup(() => setHover(null));
  const at = (event: MouseEvent) => { const box = canvas.getBoundingClientRect(); return nearestTo(places(), { x: event.clientX - box.left, y: event.clientY - box.top }); };
  const go = (i: number | undefined) => {
    if (i === undefined) return;
    setSelected(entity());
    setCursor(map()!.times[i]!);
  };
  // What is told of a moment stays inside of the picture, with a smaller image in a low one.
  const isSmall = () => size().height < 190;
  const toldTop = (y: number) => { const height = path() === undefined ? 44 : isSmall() ? 100 : 134; return Math.round(Math.max(2, Math.min(y - height / 2, size().height - height - 2))); };
  const here = () => hovered() ?? pinned() ?? 0;
  const onKey = (event: KeyboardEvent) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const end = map()!.times.length - 1;
    const by = (event.key === 'ArrowRight' || event.key === 'ArrowDown' ? 1 : event.key === 'ArrowLeft' || event.key === 'ArrowUp' ? -1 : 0) * (event.shiftKey ? 10 : 1);
    if (by !== 0) point(Math.max(0, Math.min(end, here() + by)));
    else if (event.key === 'Home' || event.key === 'End') point(event.key === 'Home' ? 0 : end);
    else if (event.key === 'Enter') go(here());
    else if (event.key === 'Escape' && hovered() !== undefined) point(undefined);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const recordings = createMemo(() => [...new Set(map()?.recordings ?? [])].sort((a, b) => a - b));
  const recordingOf = (i: number) => (recordings().length > 1 ? `, recording ${map()!.recordings[i]! + 1} of ${recordings().length}` : '');
  const legend = (): LegendEntry[] => {
    const found = map()!;
    if (colourBy() === 'recording') {
      const named = recordings().slice(0, kMaxNamed).map((which) => ({ which, colour: recordingColour(which, theme()), label: `recording ${which + 1}` }));
      return recordings().length > kMaxNamed ? [...named, { which: 0, colour: 'transparent', label: `and ${recordings().length - kMaxNamed} more, in the same colours` }] : named;
    }
    const steps = Array.from({ length: 12 }, (_, i) => ({ which: 0, colour: timeColour(i / 11, isDark()), label: '' }));
    return [{ which: 0, colour: 'transparent', label: formatClock(found.times[0]!, 0) }, ...steps, { which: 0, colour: 'transparent', label: formatClock(found.times.at(-1)!, 0) }];
  };
  /** The picture with its title and legend, of the size on the screen. */
  const draw = (pen: Pen, width: number, height: number): void => {
    pen.fillStyle = theme().panel;
    pen.fillRect(0, 0, width, height);
    pen.fillStyle = theme().ink;
    pen.font = `600 ${kFont}`;
    pen.textBaseline = 'middle';
    pen.fillText(`${entity()}, ${told()}`, 8, 12);
    pen.save();
    pen.translate(0, 22);
    drawMap(pen, view(placesOf(map()!, width, height - 44)), theme());
    pen.restore();
    drawLegend(pen, legend(), colourBy() === 'recording', 8, height - 11, theme());
  };
  const box = () => ({ width: Math.max(320, size().width), height: Math.max(200, size().height) + 44 });
  const savePng = () => {
    const out = document.createElement('canvas');
    draw(sized(out, box().width, box().height), box().width, box().height);
    void download(out, 'map.png');
  };
  const saveSvg = () => {
    const pen = new SvgPen(box().width, box().height, `Memory map of ${entity()}`);
    draw(pen, box().width, box().height);
    downloadSvg(pen, 'map.svg');
  };
  const told = () => { const found = map()!; const some = found.known !== undefined && found.known > found.times.length ? ` of ${formatCount(found.known)}` : ''; return `${formatCount(found.times.length)}${some} moments by ${found.coded_by || 'codes'}${found.explained === undefined ? '' : `, ${Math.round(found.explained * 100)} % of their variance`}`; };
  const rows = () => { const all = map()!.times.length; const count = Math.min(all, kMaxRows); return Array.from({ length: count }, (_, i) => Math.floor((i * all) / count)); };
  return (
    <PanelFrame panel={props.panel} icon="chart-scatter" title="Memory map" isBusy={asked.isBusy()} error={asked.error()} onRetry={asked.retry}
      actions={<>
        <IconButton icon="table" label="Show as a table" isPressed={isTable()} onClick={() => setOption(props.panel, 'table', isTable() ? '0' : '1')} />
        <IconButton icon="download" label="Save this map as PNG" isDisabled={!map() || isTable()} onClick={savePng} />
        <IconButton icon="pen-tool" label="Save this map as SVG" isDisabled={!map() || isTable()} onClick={saveSvg} />
      </>}>
      <Show when={asked.data()} fallback={<Show when={!asked.error()}><div class="skeleton map-wait" /></Show>}>
        <Show when={map()} fallback={<Empty title="Nothing is on this map yet">A night makes the codes that moments are placed by: run engram consolidate.</Empty>}>
          <div class="bar">
            <span class="segments" role="group" aria-label="Colours tell">
              <For each={['time', 'recording'] as const}>{(by) => <button aria-pressed={colourBy() === by} onClick={() => setOption(props.panel, 'colour', by)}>{by === 'time' ? 'Time' : 'Recording'}</button>}</For>
            </span>
            <span class="muted" title={map()!.space ? `Codes of ${map()!.space}. Moments that are alike lie together; the directions have no meaning of their own.` : undefined}>{told()}</span>
          </div>
          <Show when={isTable()}><MapTable map={map()!} rows={rows()} onGo={go} /></Show>
          <div class="map" hidden={isTable()} ref={sizeRef}>
            <canvas ref={canvas} class="map-canvas" role="slider" tabindex="0" aria-label="Moments of the map, in the order of time" aria-valuemin={0} aria-valuemax={map()!.times.length - 1} aria-valuenow={here()} aria-valuetext={`${formatTime(map()!.times[here()]!)}${recordingOf(here())}`}
              onPointerMove={(event) => point(at(event))} onPointerLeave={() => point(undefined)} onBlur={() => point(undefined)} onClick={(event) => go(at(event))} onKeyDown={onKey} />
            <Show when={hovered() !== undefined && places()[hovered()!]}>{(place) => (
              <div class="map-told" aria-hidden="true" classList={{ small: isSmall() }} style={{ transform: `translate(${Math.round(place().x > size().width / 2 ? place().x - 14 : place().x + 14)}px, ${toldTop(place().y)}px) translateX(${place().x > size().width / 2 ? '-100%' : '0'})` }}>
                <Show when={path() !== undefined}><Thumb id={`${entity()}/${map()!.times[hovered()!]!}`} path={path()} /></Show>
                <b>{formatClock(map()!.times[hovered()!]!, 3)}</b><span class="muted">{recordingOf(hovered()!).slice(2)}</span>
              </div>
            )}</Show>
          </div>
          <p class="map-legend" hidden={isTable()}>
            <For each={legend()}>{(entry) => <span classList={{ swatch: entry.label === '' }}><Swatch entry={entry} isShaped={colourBy() === 'recording'} />{entry.label}</span>}</For>
            <span class="map-here"><i class="map-ring" />at the cursor<Show when={pinned() === undefined}>: nothing is that old</Show></span>
          </p>
        </Show>
      </Show>
    </PanelFrame>
  );
}

const kShapes = ['M1 5a4 4 0 1 0 8 0a4 4 0 1 0 -8 0Z', 'M1 1h8v8h-8Z', 'M5 0.4L9.6 9H0.4Z', 'M5 0.4L9.6 5L5 9.6L0.4 5Z'];

function Swatch(props: { entry: LegendEntry; isShaped: boolean }) {
  return <Show when={props.entry.colour !== 'transparent'}><svg class="map-swatch" viewBox="0 0 10 10" aria-hidden="true"><path d={kShapes[props.isShaped ? props.entry.which % 4 : 1]} fill={props.entry.colour} /></svg></Show>;
}

function MapTable(props: { map: MemoryMap; rows: readonly number[]; onGo: (i: number) => void }) {
  const hasRecordings = () => props.map.recordings.length > 0;
  return (
    <div class="series-table" tabindex="0" role="region" aria-label="Moments of the map">
      <table>
        <caption>{props.rows.length} of {props.map.times.length} moments, evenly spread</caption>
        <thead><tr><th scope="col">time</th><Show when={hasRecordings()}><th scope="col">recording</th></Show><th scope="col">x</th><th scope="col">y</th></tr></thead>
        <tbody><For each={props.rows}>{(i) => (
          <tr><th scope="row"><button onClick={() => props.onGo(i)}>{formatTime(props.map.times[i]!)}</button></th>
            <Show when={hasRecordings()}><td>{props.map.recordings[i]! + 1}</td></Show><td>{formatNumber(props.map.x[i]!)}</td><td>{formatNumber(props.map.y[i]!)}</td></tr>
        )}</For></tbody>
      </table>
    </div>
  );
}
