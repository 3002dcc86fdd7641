// SPDX-License-Identifier: Apache-2.0
// What the inspector tells of an execution, a request, a refusal or a drive.
import { createEffect, createMemo, For, onCleanup, Show } from 'solid-js';
import type { Moment } from '../../api/types';
import { chosenOf, labelOf, linkOf, linksOf, parametersOf, textIn } from '../../skills/executions';
import { markOf } from '../../skills/lanes';
import { OutcomeSign } from '../../skills/OutcomeLegend';
import { describeExecution, kOutcomeWords } from '../../skills/words';
import { clicked, onScreen, setClicked, setToldExecution, type ExecutionKey } from '../../state/executions';
import { parseId, shortName, splitLevels } from '../../state/ids';
import { createRequest } from '../../state/request';
import { cursor, newsOf, setCursor } from '../../state/store';
import { formatClock, formatDuration } from '../../time/format';
import { IconButton } from '../../ui/Icon';
import { LinkChip } from '../../ui/LinkChip';
import { askExecution, askWhy, executionIn, type Told, type ToldEvent } from './ask';
import type { Step } from './why';

const kHasWhy = /^(Skill\/(Refusal|ExecutionRequest)|Navigation\/(Plan|Event))\//;
export const isTold = (entity: string): boolean => entity.startsWith('Skill/Event/') || kHasWhy.test(entity);

const isId = (value: unknown): value is string => typeof value === 'string' && splitLevels(value).length >= 4;

/** What an execution, a request, a refusal, a plan or a drive was, and why, before its bare value. */
export function ToldPart(props: { moment: Moment }) {
  const entity = () => parseId(props.moment.id).entity;
  return <Show when={entity().startsWith('Skill/Event/')} fallback={<Plain moment={props.moment} />}><OfExecution moment={props.moment} /></Show>;
}

function OfExecution(props: { moment: Moment }) {
  const key = createMemo<ExecutionKey | null>(() => {
    const [own, chosen] = [executionIn(props.moment), clicked()];
    if (chosen === null || chosen.entity !== parseId(props.moment.id).entity) return own;
    const { end } = onScreen().get(chosen.entity)?.find((one) => one.start === chosen.start) ?? {};
    return cursor() >= chosen.start && (end === undefined || cursor() <= end) ? chosen : own;
  }, null, { equals: (a, b) => a?.entity === b?.entity && a?.start === b?.start });
  createEffect(() => setToldExecution(key()));
  onCleanup(() => setToldExecution(null));
  const told = createRequest<Told>(() => {
    const asked = key();
    if (!asked) return null;
    newsOf(asked.entity);
    return { group: `${asked.entity} ${asked.start}`, run: (signal) => askExecution(asked, signal) };
  });
  return (
    <section class="told" aria-label="Execution">
      <Show when={told.error()}><p role="alert">{told.error()}</p></Show>
      <Show when={told.data()} fallback={<Show when={!told.error()}><div class="skeleton trace-wait" /></Show>}>{(known) => <Execution told={known()} />}</Show>
      <OnScreen entity={parseId(props.moment.id).entity} start={key()?.start} />
    </section>
  );
}

function Execution(props: { told: Told }) {
  const first = () => props.told.events[0];
  const last = () => props.told.events.at(-1);
  const end = () => { const one = last(); return one?.stage === 'ended' ? one : undefined; };
  const outcome = () => end()?.outcome ?? 'running';
  const reports = () => props.told.events.filter((one) => one.stage === 'report');
  const all = () => onScreen().get(props.told.key.entity) ?? [];
  const beside = (by: number) => { const here = all().findIndex((one) => one.start === props.told.key.start); return here < 0 ? undefined : all()[here + by]; };
  const go = (by: number) => { const next = beside(by); if (next) goTo(next.entity, next.start); };
  return (
    <>
      <h3>
        <OutcomeSign outcome={outcome()} />{labelOf(props.told.key.entity, first()?.parameters ?? '')}
        <span class="muted">{kOutcomeWords[outcome()]}{end() ? ` after ${formatDuration(end()!.time - props.told.key.start)}` : ''}</span>
        <span class="steps">
          <IconButton icon="arrow-left" label="Execution before on the screen" isDisabled={!beside(-1)} onClick={() => go(-1)} />
          <IconButton icon="arrow-right" label="Next execution on the screen" isDisabled={!beside(1)} onClick={() => go(1)} />
        </span>
      </h3>
      <Show when={end()?.reason}>{(reason) => <p class="reason">{reason()}</p>}</Show>
      <dl class="facts">
        <Parameters text={first()?.parameters ?? ''} />
        <dt>Started</dt><dd>{formatClock(props.told.key.start)}</dd>
        <Show when={end()}>{(one) => <><dt>Ended</dt><dd>{formatClock(one().time)}</dd></>}</Show>
        <Show when={(end()?.stoppedBy.length ?? 0) > 0}><dt>Stopped by</dt><dd><Chips ids={end()!.stoppedBy} /></dd></Show>
        <Show when={end() && end()!.result !== '' && end()!.result !== '{}'}><dt>Result</dt><dd><Values text={end()!.result} /></dd></Show>
      </dl>
      <Why steps={props.told.why} />
      <Show when={reports().length > 0}>
        <details open={reports().length <= 6}>
          <summary>{reports().length} {reports().length === 1 ? 'report' : 'reports'}{props.told.omitted > 0 ? `, and ${props.told.omitted} before these` : ''}</summary>
          <ol><For each={reports()}>{(report) => <Report report={report} from={props.told.key.start} />}</For></ol>
        </details>
      </Show>
    </>
  );
}

function goTo(entity: string, start: bigint): void {
  setCursor(start);
  setClicked({ entity, start });
}

function Report(props: { report: ToldEvent; from: bigint }) {
  return <li><span class="muted">+{formatDuration(props.report.time - props.from)}</span> {props.report.reason} <Values text={props.report.result} /> <Chips ids={props.report.results} /></li>;
}

const plainText = (value: unknown): string => (typeof value === 'string' ? value : typeof value === 'number' ? String(Number(value.toPrecision(6))) : JSON.stringify(value));

function Values(props: { text: string }) {
  return <>{parametersOf(props.text).map(([key, value]) => `${key}: ${isId(value) ? shortName(parseId(value).entity) : plainText(value)}`).join(', ')}</>;
}

function Parameters(props: { text: string }) {
  return <For each={parametersOf(props.text)}>{([key, value]) => <><dt>{key}</dt><dd>{isId(value) ? <LinkChip id={value} direction="to" path="" /> : plainText(value)}</dd></>}</For>;
}

const Chips = (props: { ids: readonly string[] }) => <For each={props.ids}>{(id) => <LinkChip id={id} direction="to" path="" />}</For>;

function Why(props: { steps: readonly Step[] }) {
  return (
    <Show when={props.steps.length > 0}>
      <div><span class="muted">Why</span>
        <ol aria-label="Why"><For each={props.steps}>{(step) => <li><Show when={step.quote} fallback={step.what}>{step.what}: <q>{step.quote}</q></Show> <LinkChip id={step.id} direction="to" path="" /></li>}</For></ol>
      </div>
    </Show>
  );
}

/** The executions that the lane of this entity shows, for who does not see or click bars. */
function OnScreen(props: { entity: string; start: bigint | undefined }) {
  const all = () => onScreen().get(props.entity) ?? [];
  return (
    <Show when={all().length > 0}>
      <details>
        <summary>{all().length} {all().length === 1 ? 'execution' : 'executions'} on the screen</summary>
        <div class="told-list"><table>
          <thead><tr><th scope="col">execution</th><th scope="col">outcome</th><th scope="col">started</th><th scope="col">took</th></tr></thead>
          <tbody><For each={all().slice(-500)}>{(one) => (
            <tr><th scope="row"><button aria-current={one.start === props.start ? 'true' : undefined} title={describeExecution(one)} onClick={() => goTo(props.entity, one.start)}>{one.label}</button></th>
              <td>{kOutcomeWords[one.outcome]}</td><td>{formatClock(one.start)}</td><td>{one.end === undefined ? '' : formatDuration(one.end - one.start)}</td></tr>
          )}</For></tbody>
        </table></div>
      </details>
    </Show>
  );
}

const kPlanStates = ['planned', 'refused'] as const;

/** A title for what is no execution. */
function titleOf(moment: Moment, data: unknown): string {
  const { entity } = parseId(moment.id);
  if (!entity.startsWith('Navigation/Plan/')) return markOf(moment.id, data)?.what.split(':')[0] ?? shortName(entity);
  const state = chosenOf((data as Record<string, unknown> | undefined)?.state, kPlanStates);
  return `Plan to ${textIn(data, 'goal') || 'a place'}${state === 'refused' ? ', refused' : ''}`;
}

function Plain(props: { moment: Moment }) {
  const data = () => props.moment.instances[0]?.data;
  const part = (key: string): unknown => (data() as Record<string, unknown> | undefined)?.[key];
  const why = createRequest<Step[]>(() => { const moment = props.moment; return moment.source === 'predicted' ? null : { group: moment.id, run: (signal) => askWhy(moment, signal) }; });
  const unmet = () => { const list = part('unmet'); return Array.isArray(list) ? list.filter((one): one is string => typeof one === 'string') : []; };
  const related = () => [['Found in', linksOf(part('found'))], ['Blocked by', linksOf(part('blocked_by'))], ['Map', [linkOf(part('cost_map'))].filter((id) => id !== '')]] as const;
  return (
    <section class="told" aria-label="What was meant">
      <h3>{titleOf(props.moment, data())}</h3>
      <Show when={textIn(data(), 'reason')}>{(reason) => <p class="reason">{reason()}</p>}</Show>
      <dl class="facts">
        <Parameters text={textIn(data(), 'parameters')} />
        <Show when={unmet().length > 0}><dt>Not met</dt><dd><ul><For each={unmet()}>{(one) => <li>{one}</li>}</For></ul></dd></Show>
        <For each={related()}>{([name, ids]) => <Show when={ids.length > 0}><dt>{name}</dt><dd><Chips ids={ids} /></dd></Show>}</For>
      </dl>
      <Why steps={why.data() ?? []} />
    </section>
  );
}
