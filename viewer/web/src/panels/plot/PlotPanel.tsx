// SPDX-License-Identifier: Apache-2.0
import type uPlot from 'uplot';
import { createEffect, createMemo, createSignal, For, on, onCleanup, Show, untrack } from 'solid-js';
import { createMembers } from '../../state/moment';
import { createRequest } from '../../state/request';
import { cursor, hover, info, last, limits, liveLast, ownLast, setCursor, setHover, setOption, setView, view, type Panel } from '../../state/store';
import { restCursor } from '../../state/moving';
import { formatNumber } from '../../time/format';
import { pan, timeAt, zoom } from '../../time/span';
import { wider } from '../../timeline/density';
import { listen } from '../../timeline/gestures';
import { download, downloadSvg } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import { createSize, perFrame } from '../../ui/size';
import { SvgPen, type Pen } from '../../ui/svg';
import { sized, theme } from '../../ui/theme';
import { createChart, dataOf, drawChart, kTitleHeight, lineAt, styleOf, type Shown } from './chart';
import { askSeries, valueAt, type Plotted } from './data';
import { foresee, type Foreseen } from './future';
import { SeriesPicker } from './SeriesPicker';
import { SeriesTable } from './SeriesTable';

/** How far a prediction from a past moment reaches at most. */
const kReachNs = 2_000_000_000n;
/** How much longer than a prediction the pause behind it is at least, while a memory grows. */
const kPredictingPause = 19;

async function timed<T>(run: () => Promise<T>, told: (ms: number) => void): Promise<T> {
  const begin = performance.now();
  const value = await run();
  told(performance.now() - begin);
  return value;
}

/** How long the gateway may read for a plot that rests. */
const kWholeMs = 5000;

export function PlotPanel(props: { panel: Panel }) {
  const [size, sizeRef] = createSize();
  const [isPicking, setPicking] = createSignal(false);
  const [hidden, setHidden] = createSignal<ReadonlySet<string>>(new Set());
  const [coarse, setCoarse] = createSignal<Foreseen | null>(null);
  const members = createMembers(() => props.panel.entity);
  const numbers = createMemo(() => (members.data() ?? []).filter((member) => member.kind === 'number'));
  const isTable = () => props.panel.options.table === '1';
  const fromHere = () => props.panel.options.from === '1';
  const width = () => Math.max(0, size().width - 62);

  const plotted = createRequest<Plotted>(() => {
    liveLast();
    const { entity, paths } = props.panel;
    const span = wider(view());
    const pixels = Math.min(4000, width() * 2);
    if (paths.length === 0 || pixels < 20) return null;
    return { group: `${entity} ${paths.join(' ')}`, run: (signal) => askSeries(entity, paths, span, pixels, signal) };
  });
  // What the gateway could not read in time it reads once the picture rests.
  const [restView, setRestView] = createSignal(view());
  createEffect(() => {
    const here = view();
    const timer = setTimeout(() => setRestView(here), 400);
    onCleanup(() => clearTimeout(timer));
  });
  const whole = createRequest<Plotted>(() => {
    const rough = plotted.data();
    const { entity, paths } = props.panel;
    if (!rough || rough.share >= 1 || restView() !== view()) return null;
    return { group: `${entity} ${paths.join(' ')} ${rough.span.from} ${rough.span.to}`, run: (signal) => askSeries(entity, paths, rough.span, rough.pixels, signal, kWholeMs) };
  });
  const best = createMemo(() => whole.data() ?? plotted.data());
  // A prediction costs more than a value, so a memory that grows is predicted anew once a second, or
  // less often: whoever predicts is the robot itself, of which this takes a twentieth at most.
  const [tookMs, setTookMs] = createSignal(0);
  const pauseNs = () => BigInt(Math.max(1000, Math.round(kPredictingPause * tookMs()))) * 1_000_000n;
  const newest = createMemo<bigint>((before) => { const own = ownLast(props.panel.entity); return own < before || own - before >= untrack(pauseNs) ? own : before; }, 0n);
  // Behind the last snapshot, as far as the screen reaches; or from the cursor, beside what came.
  const foreseen = createRequest<Foreseen>(() => {
    const { entity, paths } = props.panel;
    const most = info()?.max_horizon_ns ?? 0n;
    const isPast = fromHere() && restCursor() > 0n && restCursor() < last();
    const from = isPast ? restCursor() : newest();
    const wanted = isPast ? kReachNs : restView().to - from;
    const reach = wanted < most ? wanted : most;
    if (paths.length === 0 || reach <= 0n) return null;
    return { group: `${entity} ${paths.join(' ')} ${isPast}`, run: (signal) => timed(() => foresee(entity, paths, isPast ? from : undefined, reach, setCoarse, signal), setTookMs) };
  });
  createEffect(on(() => [props.panel.entity, props.panel.paths, fromHere()], () => setCoarse(null)));
  const shownFuture = () => foreseen.data() ?? (foreseen.isBusy() ? coarse() : null);

  let host!: HTMLDivElement;
  let chart: uPlot | undefined;
  let stop = (): void => {};
  const [box, setBox] = createSignal({ left: 0, width: 0 });
  const shown = (): Shown => ({ plotted: untrack(best)!, view: untrack(view), last: untrack(last), foreseen: untrack(shownFuture), isShown: (path) => !untrack(hidden).has(path) });
  const destroy = (): void => { stop(); chart?.destroy(); chart = undefined; };
  onCleanup(destroy);

  const wire = (over: HTMLElement): void => {
    const time = (x: number) => timeAt(Math.max(0, Math.min(over.clientWidth, x)), view(), over.clientWidth);
    stop = listen(over, {
      zoom: (x, factor) => setView(zoom(view(), x, over.clientWidth, factor, limits())),
      pan: (dx) => setView(pan(view(), dx, over.clientWidth, limits())),
      hover: (x) => setHover(x === null ? null : time(x)),
      pick: (x) => setCursor(time(x), false),
      scrub: (x) => setCursor(time(x), false),
      select: (from, to) => { const [a, b] = [time(Math.min(from, to)), time(Math.max(from, to))]; if (b > a) setView({ from: a, to: b }); },
      isScrubbing: () => false,
    });
  };
  // A new chart where series, size or colours change; otherwise the old one gets new data.
  const kind = createMemo(() => (best() && size().width > 80 && size().height > 60 && !isTable() ? `${best()!.paths.join(' ')} ${[...hidden()].join(' ')} ${size().width} ${size().height}` : ''));
  createEffect(on([kind, theme], () => {
    destroy();
    if (kind() === '') return;
    chart = createChart(host, untrack(size).width, untrack(size).height, shown, theme());
    wire(chart.over);
    setBox({ left: chart.bbox.left / devicePixelRatio, width: chart.bbox.width / devicePixelRatio });
  }));
  const repaint = perFrame(() => { if (chart && best()?.paths.length === chart.series.length - 1) chart.setData(dataOf(best()!), true); });
  createEffect(() => { best(); view(); last(); foreseen.data(); coarse(); repaint(); });

  const line = (time: bigint | null) => { const at = lineAt(time, view(), box().width); return at === null ? 'none' : `translateX(${at + box().left}px)`; };
  const time = () => hover() ?? cursor();
  const toggle = (path: string) => { const next = new Set(hidden()); if (!next.delete(path)) next.add(path); setHidden(next); };
  const label = (path: string) => { const member = numbers().find((other) => other.path === path); return member?.name ? `${member.name} ${/velocit/i.test(path) ? 'velocity' : ''}`.trim() : path || 'value'; };
  const unitOf = (path: string) => numbers().find((other) => other.path === path)?.unit ?? '';
  const draw = (pen: Pen, drawn: uPlot) => drawChart(pen, drawn, shown(), props.panel.paths.map(label), props.panel.entity, theme());
  const savePng = () => {
    if (!chart || !best()) return;
    const out = document.createElement('canvas');
    draw(sized(out, chart.width, chart.height + kTitleHeight), chart);
    void download(out, 'plot.png');
  };
  const saveSvg = () => {
    if (!chart || !best()) return;
    const pen = new SvgPen(chart.width, chart.height + kTitleHeight, `${props.panel.entity}: ${props.panel.paths.join(', ')}`);
    draw(pen, chart);
    downloadSvg(pen, 'plot.svg');
  };
  return (
    <PanelFrame panel={props.panel} icon="chart-line" title="Plot" isBusy={plotted.isBusy() || whole.isBusy()} error={plotted.error() || members.error() || foreseen.error()} onRetry={() => [plotted, members, foreseen].forEach((one) => { if (one.error()) one.retry(); })}
      actions={<>
        <IconButton icon="search" label="Choose series" isPressed={isPicking()} onClick={() => setPicking(!isPicking())} />
        <IconButton icon="sparkles" label="Predict from the cursor" isPressed={fromHere()} onClick={() => setOption(props.panel, 'from', fromHere() ? '0' : '1')} />
        <IconButton icon="table" label="Show as a table" isPressed={isTable()} onClick={() => setOption(props.panel, 'table', isTable() ? '0' : '1')} />
        <IconButton icon="download" label="Save this plot as PNG" isDisabled={isTable()} onClick={savePng} />
        <IconButton icon="pen-tool" label="Save this plot as SVG" isDisabled={isTable()} onClick={saveSvg} />
      </>}>
      <div class="plot-legend" role="group" aria-label="Series shown">
        <For each={props.panel.paths}>{(path, i) => (
          <button class="series-key" aria-pressed={!hidden().has(path)} title={`${hidden().has(path) ? 'Show' : 'Hide'} ${path} ${label(path)}`} onClick={() => toggle(path)}>
            <i style={{ background: styleOf(i(), theme()).colour }} /><span class="series-name">{label(path)}</span>
            <output>{best() && Number.isFinite(valueAt(best()!, i(), time())) ? formatNumber(valueAt(best()!, i(), time())) : '–'}<span class="unit"> {unitOf(path)}</span></output>
          </button>
        )}</For>
        <Show when={(best()?.share ?? 1) < 1}><span class="muted" title="The gateway reads on while the picture rests">{Math.max(1, Math.round(best()!.share * 100))} % read</span></Show>
        <Show when={shownFuture()?.engine}><span class="muted engine">predicted by {shownFuture()!.engine}</span></Show>
      </div>
      <Show when={isPicking()}><SeriesPicker panel={props.panel} members={numbers()} onClose={() => setPicking(false)} /></Show>
      <Show when={props.panel.paths.length > 0} fallback={<Empty title="No series is chosen"><button onClick={() => setPicking(true)}>Choose series</button></Empty>}>
        <Show when={isTable() && best()}><SeriesTable plotted={best()!} labels={props.panel.paths.map(label)} /></Show>
        <div class="plot" hidden={isTable()} ref={sizeRef}>
          <div class="plot-host" role="img" aria-label={`Plot of ${props.panel.paths.map(label).join(', ')}; shown as a table on request`} ref={host} />
          <div class="plot-line pinned" classList={{ future: cursor() > last() }} style={{ transform: line(cursor()) === 'none' ? 'translateX(-10px)' : line(cursor()), visibility: line(cursor()) === 'none' ? 'hidden' : 'visible' }} />
          <div class="plot-line hovering" style={{ transform: line(hover()) === 'none' ? 'translateX(-10px)' : line(hover()), visibility: line(hover()) === 'none' ? 'hidden' : 'visible' }} />
          <Show when={!plotted.data() && !plotted.error()}><div class="skeleton cover" /></Show>
        </div>
      </Show>
    </PanelFrame>
  );
}
