// SPDX-License-Identifier: Apache-2.0
import { createMemo, createSignal, For, Show } from 'solid-js';
import { getJson } from '../../api/client';
import { calledOff, forgetPlan, type ForgetPlan } from '../../api/nightTypes';
import { copy, word } from '../../state/actions';
import { createRequest } from '../../state/request';
import { info, setOptions, type Panel } from '../../state/store';
import { Empty } from '../../ui/PanelFrame';
import { ForgetPicture } from './ForgetPicture';
import { errorText, fieldOf, forgetCommand, kFields, newPageName, paramsOf } from './policy';

const kExample = 'forget:\n  rules:\n    - {match: Vision, older_than: 30d}\n  fade:\n    - {match: Vision, after: 7d, psnr: 32}\n';

/** What forgetting by a policy would do. It is planned; nothing here can carry it out. */
export function ForgettingPart(props: { panel: Panel }) {
  const page = newPageName();
  const [isPasted, setPasted] = createSignal(false);
  const [text, setText] = createSignal('');
  /** What was asked for last; the form's part of it is in the address, too. */
  const first = paramsOf(props.panel.options);
  const [asking, setAsking] = createSignal<{ readonly params: Readonly<Record<string, string>>; readonly attempt: number } | null>(Object.keys(first).length > 0 ? { params: first, attempt: 0 } : null);
  const asked = createRequest<ForgetPlan>(() => {
    const now = asking();
    if (now === null || !info()) return null;
    return { group: `${now.attempt} ${JSON.stringify(now.params)}`, run: (signal) => getJson('forgetting', { ...now.params, page }, forgetPlan, signal) };
  });
  const wrong = () => fieldOf(asked.error());
  let form!: HTMLFormElement;
  const plan = () => {
    const typed = Object.fromEntries([...new FormData(form)].map(([name, value]) => [name, String(value)]));
    const params = isPasted() ? { config: text() } : paramsOf(typed);
    if (!isPasted()) setOptions(props.panel, Object.fromEntries(kFields.map(({ name }) => [name, params[name as keyof typeof params] ?? ''])));
    setAsking({ params, attempt: (asking()?.attempt ?? 0) + 1 });
  };
  const stop = () => {
    setAsking(null);
    void getJson('forgetting', { page, stop: 1 }, calledOff).catch(() => undefined);
  };
  const store = () => info()?.stores[0]?.path;
  const command = createMemo(() => { const found = asked.data(); return found ? forgetCommand(found.config, word(store() ?? 'STORE')) : ''; });
  return (
    <Show when={store() !== undefined} fallback={<Empty title="A server does not tell this">What its stores would forget is known where they are: engram view STORE there, or engram forget STORE --config FILE --dry-run.</Empty>}>
      <form class="policy" ref={form} onSubmit={(event) => { event.preventDefault(); plan(); }}>
        <Show when={!isPasted()} fallback={
          <label class="policy-config"><span class="unseen">Configuration</span><textarea class="mono" rows={7} spellcheck={false} placeholder={kExample} value={text()} aria-invalid={asked.error() !== '' && wrong() === undefined} aria-describedby="policy-error" onInput={(event) => setText(event.currentTarget.value)} /></label>}>
          <For each={kFields}>{(field) => (
            <label class="field" title={field.title}>{field.label}
              <input name={field.name} size={field.size} spellcheck={false} autocomplete="off" placeholder={field.hint} value={props.panel.options[field.name] ?? ''} aria-invalid={wrong() === field.name} aria-describedby="policy-error" />
            </label>
          )}</For>
        </Show>
        <span class="policy-buttons">
          <Show when={asked.isBusy()} fallback={<button type="submit" class="main-button">Show what would go</button>}><button type="button" onClick={stop}>Stop</button></Show>
          <button type="button" aria-pressed={isPasted()} title="Paste the section 'forget' of a configuration" onClick={() => { if (!isPasted() && text() === '' && asked.data()) setText(asked.data()!.config); setPasted(!isPasted()); }}>As YAML</button>
          <Show when={asked.data()}><button type="button" onClick={() => void copy(command(), 'the command')}>Copy engram forget</button></Show>
        </span>
      </form>
      <p class="policy-hint muted">Nothing is changed here: this is a dry run. Only <code>engram forget</code> in a shell carries it out.</p>
      <div id="policy-error"><Show when={asked.error()}><div class="failure" role="alert"><p>{errorText(asked.error())}</p></div></Show></div>
      <Show when={asked.isBusy()}><p class="bar muted" role="status">planning ...</p></Show>
      <Show when={asked.data()}><ForgetPicture found={asked.data()!} /></Show>
    </Show>
  );
}
