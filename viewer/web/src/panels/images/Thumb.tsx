// SPDX-License-Identifier: Apache-2.0
import { createMemo, Show } from 'solid-js';
import { getImage } from '../../api/client';
import { Turns } from '../../api/turns';
import { createRequest } from '../../state/request';
import { Bitmap, closeReplaced } from './PictureTile';

const turns = new Turns(3);

/** A small image of a snapshot; nothing where its entity has no image. */
export function Thumb(props: { id: string; path: string | undefined }) {
  const picture = createRequest(() => (props.path === undefined ? null : {
    group: `${props.id} ${props.path}`,
    run: (signal: AbortSignal) => turns.run(() => getImage({ id: props.id, path: props.path, form: 'any', as: 'jpeg', quality: 80 }, signal), signal),
  }));
  closeReplaced(createMemo(() => { const shown = picture.data(); return shown ? [shown.bitmap] : []; }));
  return (
    <span class="thumb-picture">
      <Show when={picture.data()} fallback={<span class="muted">{picture.error() ? 'no image' : ''}</span>}>{(shown) => <Bitmap bitmap={shown().bitmap} label="" />}</Show>
    </span>
  );
}
