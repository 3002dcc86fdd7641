// SPDX-License-Identifier: Apache-2.0
// Questions in English, and what the robot did in the stretch of time on the screen.
import { createMemo, createSignal, For, Show } from 'solid-js';
import { getJson } from '../../api/client';
import { answer, narration, type Answer } from '../../api/asked';
import { createRequest } from '../../state/request';
import { cursor, last, setOptions, view, type Panel } from '../../state/store';
import { formatTime } from '../../time/format';
import { LinkChip } from '../../ui/LinkChip';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import '../../ui/asked.css';

const kExamples = ['What did you do today?', 'What went wrong?', 'Why did you stop?', 'What were you doing then?'];
/** Evidence that is shown before somebody wants all of it. */
const kShown = 12;

/** Until the screen rests: each stretch on the way to it would be told for nothing. */
const rest = (signal: AbortSignal): Promise<void> => new Promise((done, fail) => {
  const timer = setTimeout(done, 250);
  signal.addEventListener('abort', () => { clearTimeout(timer); fail(new DOMException('aborted', 'AbortError')); });
});

/** Asks the memory in words; what an answer rests on opens with a click. */
export default function AskPanel(props: { panel: Panel }) {
  const question = () => props.panel.options.q ?? '';
  const tells = () => (props.panel.options.tell ?? '') !== '';
  const [text, setText] = createSignal(question());
  // "Now" is where the cursor is, so that "a minute ago" means what is on the screen.
  const [now, setNow] = createSignal(cursor());
  const ask = (words: string) => {
    setText(words);
    setNow(cursor() === 0n || cursor() > last() ? last() : cursor());
    setOptions(props.panel, { tell: '', q: words.trim() });
  };
  const asked = createRequest(() => (question() === '' || tells() ? null : {
    group: question(),
    run: (signal: AbortSignal) => getJson('ask', { q: question(), now: now() || undefined }, answer, signal),
  }));
  const told = createRequest(() => {
    const here = view();
    return !tells() || here.to <= here.from ? null : { group: 'tell', run: async (signal: AbortSignal) => { await rest(signal); return getJson('tell', { from: here.from, until: here.to }, narration, signal); } };
  });
  return (
    <PanelFrame panel={props.panel} icon="message" title="Ask" isBusy={asked.isBusy() || told.isBusy()} error={asked.error() ?? told.error()} onRetry={() => { asked.retry(); told.retry(); }}>
      <form class="bar" onSubmit={(event) => { event.preventDefault(); ask(text()); }}>
        <input class="grow" aria-label="Question" placeholder="What did you do with the salt?" maxlength="2000" value={text()} onInput={(event) => setText(event.currentTarget.value)} />
        <button type="submit">Ask</button>
        <button type="button" aria-pressed={tells()} onClick={() => setOptions(props.panel, { tell: tells() ? '' : '1' })}>Tell this stretch</button>
      </form>
      <Show when={tells()} fallback={<Show when={asked.data()} fallback={<Show when={!asked.isBusy() && !asked.error()}><Examples onAsk={ask} /></Show>}>{(found) => <Told answer={found()} now={now()} />}</Show>}>
        <Show when={told.data()}>{(found) => (
          <Show when={found().sentences.length > 0} fallback={<Empty title="Nothing to tell">The robot did nothing then that it would tell of.</Empty>}>
            <ol class="narration"><For each={found().sentences}>{(one) => (
              <li class={`told-${one.level}`}><p>{one.text}</p><Evidence links={one.links.map((id) => ({ id, role: '' }))} shown={3} /></li>
            )}</For></ol>
          </Show>
        )}</Show>
      </Show>
    </PanelFrame>
  );
}

function Examples(props: { onAsk: (words: string) => void }) {
  return (
    <Empty title="Ask in English">
      What, when, where, who, why, how long, how often, and what went wrong.
      <span class="examples"><For each={kExamples}>{(one) => <button type="button" onClick={() => props.onAsk(one)}>{one}</button>}</For></span>
    </Empty>
  );
}

function Told(props: { answer: Answer; now: bigint }) {
  const isKnown = () => props.answer.value.kind !== 'unknown';
  return (
    <div class="answer" role="status">
      <p class="answer-text" classList={{ unknown: !isKnown() }}>{props.answer.text}</p>
      <Show when={!isKnown() && props.answer.looked_for}><p class="muted">Looked for {props.answer.looked_for}.</p></Show>
      <Evidence links={props.answer.evidence} shown={kShown} />
      <p class="muted answer-how">
        {props.answer.route} · {Math.round(props.answer.confidence * 100)} % · {props.answer.took_ms.toFixed(props.answer.took_ms < 10 ? 1 : 0)} ms · as of {formatTime(props.now)}
        <Show when={props.answer.program}><code>{props.answer.program}</code></Show>
      </p>
    </div>
  );
}

function Evidence(props: { links: readonly { id: string; role: string }[]; shown: number }) {
  const [all, setAll] = createSignal(false);
  const links = createMemo(() => (all() ? props.links : props.links.slice(0, props.shown)));
  return (
    <Show when={props.links.length > 0}>
      <span class="chips evidence">
        <For each={links()}>{(one) => <LinkChip id={one.id} direction="to" path={one.role} />}</For>
        <Show when={links().length < props.links.length}><button type="button" onClick={() => setAll(true)}>{props.links.length - links().length} more</button></Show>
      </span>
    </Show>
  );
}
