// SPDX-License-Identifier: Apache-2.0
import { follow } from '../state/actions';
import { parseId, shortName } from '../state/ids';
import { cursor } from '../state/store';
import { formatDuration } from '../time/format';

/** A link to or from a snapshot; a click goes there. */
export function LinkChip(props: { id: string; direction: 'to' | 'from'; path: string }) {
  const parts = () => parseId(props.id);
  const away = () => { const time = parts().time; return time === undefined ? '' : time === cursor() ? 'now' : `${time > cursor() ? '+' : '−'}${formatDuration(time > cursor() ? time - cursor() : cursor() - time)}`; };
  const name = () => { const levels = parts().entity.split('/'); return levels.length > 2 ? `${levels.at(-2)}/${shortName(parts().entity)}` : parts().entity; };
  return (
    <button class={`chip ${props.direction}`} title={props.id} onClick={() => follow(props.id)}>
      <span class="unseen">{`${props.direction === 'to' ? 'Links to' : 'Linked from'} ${props.id}${props.path ? `, member ${props.path}` : ''}: `}</span>
      <span aria-hidden="true">{props.direction === 'to' ? '→' : '←'}</span> {name()} <span class="away">{away()}</span>
    </button>
  );
}
