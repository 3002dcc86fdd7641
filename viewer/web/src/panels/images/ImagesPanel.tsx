// SPDX-License-Identifier: Apache-2.0
import { createMemo, For, Show } from 'solid-js';
import { isImage } from '../../api/types';
import { createMembers, createMoment } from '../../state/moment';
import { isMoving } from '../../state/moving';
import { createRequest } from '../../state/request';
import { nodeOf, say, setOption, type Panel } from '../../state/store';
import { download } from '../../ui/download';
import { IconButton } from '../../ui/Icon';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
import { theme } from '../../ui/theme';
import { Compare } from './Compare';
import { loadForesight, loadTiles, type Tile } from './load';
import { captionOf, closeReplaced, PictureTile } from './PictureTile';

const kHorizons = [['200000000', '+200 ms'], ['400000000', '+400 ms'], ['1000000000', '+1 s']] as const;
const kModes = [['side', 'Side'], ['blink', 'Blink'], ['slide', 'Slide']] as const;

export function ImagesPanel(props: { panel: Panel }) {
  const entity = () => props.panel.entity;
  const option = (key: string, otherwise: string) => props.panel.options[key] ?? otherwise;
  const moment = createMoment(entity);
  const members = createMembers(entity);
  const images = createMemo(() => (members.data() ?? []).filter((member) => isImage(member.kind)).map((member) => member.path));
  // The path of a value that is an image itself is empty.
  const path = (): string | undefined => props.panel.paths[0] ?? images()[0];
  const instance = () => Number(option('i', '0'));
  const horizon = () => BigInt(/^\d+$/.test(option('h', '0')) ? option('h', '0') : '0');
  const tiles = createRequest<Tile[]>(() => {
    const here = moment.data();
    const member = path();
    if (!here || member === undefined) return null;
    const asked = { entity: entity(), path: member, instance: instance(), isMoving: isMoving() };
    const ahead = horizon();
    const foresees = ahead > 0n && here.source !== 'predicted';
    return {
      group: `${entity()} ${member} ${instance()} ${ahead} ${here.source === 'predicted'}`,
      run: (signal) => (foresees ? loadForesight(asked, here, ahead, signal) : loadTiles(asked, here, signal)),
    };
  });
  closeReplaced(createMemo(() => (tiles.data() ?? []).flatMap((tile) => (tile.picture ? [tile.picture.bitmap] : []))));
  const instances = () => moment.data()?.instances.length ?? 1;
  const eye = (i: number) => (instances() === 2 && /stereo/i.test(entity()) ? ['left', 'right'][i]! : String(i));
  // Recorded with reconstructed, or else predicted with what is beside it.
  const compared = (shown: readonly Tile[]) => { const from = shown.length === 3 && horizon() > 0n ? 1 : 0; return { first: shown[from]!, second: shown[from + 1]! }; };
  const error = () => moment.error() || members.error() || tiles.error();
  return (
    <PanelFrame panel={props.panel} icon="image" title="Images" isBusy={moment.isBusy() || tiles.isBusy()} error={error()} onRetry={() => [moment, members, tiles].find((one) => one.error())?.retry()}
      actions={<IconButton icon="download" label="Save these images as PNG" isDisabled={!tiles.data()} onClick={() => void save(tiles.data() ?? [], nodeOf(entity())?.name ?? 'images')} />}>
      <div class="bar">
        <span class="segments" role="group" aria-label="How to compare">
          <For each={kModes}>{([mode, label]) => <button aria-pressed={option('m', 'side') === mode} onClick={() => setOption(props.panel, 'm', mode)}>{label}</button>}</For>
        </span>
        <Show when={instances() > 1}>
          <span class="segments" role="group" aria-label="Instance">
            <For each={Array.from({ length: instances() }, (_, i) => i)}>{(i) => <button aria-pressed={instance() === i} onClick={() => setOption(props.panel, 'i', String(i))}>{eye(i)}</button>}</For>
          </span>
        </Show>
        <label class="field">predict ahead
          <select onChange={(event) => setOption(props.panel, 'h', event.currentTarget.value)}>
            <option value="0" selected={horizon() === 0n}>off</option>
            <For each={kHorizons}>{([value, label]) => <option value={value} selected={option('h', '0') === value}>{label}</option>}</For>
          </select>
        </label>
      </div>
      <Show when={!members.data() || images().length > 0} fallback={<Empty title="No images here">This entity has no member that is an image.</Empty>}>
        <Show when={tiles.data()} fallback={<Show when={!error()}><div class="tiles"><div class="skeleton square" /><div class="skeleton square" /><div class="skeleton square" /></div></Show>}>
          {(shown) => (
            <Show when={option('m', 'side') === 'side' || shown().length < 2} fallback={<Compare {...compared(shown())} mode={option('m', 'side') as 'blink' | 'slide'} />}>
              <div class="tiles"><For each={shown()}>{(tile) => <PictureTile tile={tile} />}</For></div>
            </Show>
          )}
        </Show>
      </Show>
    </PanelFrame>
  );
}

/** One picture of all tiles, with what is written below them. */
async function save(tiles: readonly Tile[], name: string): Promise<void> {
  const shown = tiles.filter((tile) => tile.picture);
  if (shown.length === 0) return say('There is no image to save.');
  const scale = Math.max(1, Math.round(256 / shown[0]!.picture!.bitmap.width));
  const width = Math.max(...shown.map((tile) => tile.picture!.bitmap.width)) * scale;
  const height = Math.max(...shown.map((tile) => tile.picture!.bitmap.height)) * scale;
  const canvas = document.createElement('canvas');
  canvas.width = shown.length * (width + 8) - 8;
  canvas.height = height + 40;
  const c = canvas.getContext('2d')!;
  c.fillStyle = theme().panel;
  c.fillRect(0, 0, canvas.width, canvas.height);
  c.imageSmoothingEnabled = false;
  c.textBaseline = 'top';
  shown.forEach((tile, i) => {
    c.drawImage(tile.picture!.bitmap, i * (width + 8), 0, width, height);
    c.fillStyle = theme().ink;
    c.font = 'bold 12px sans-serif';
    c.fillText(tile.title, i * (width + 8) + 2, height + 5, width);
    c.font = '11px sans-serif';
    c.fillText(captionOf(tile), i * (width + 8) + 2, height + 22, width);
  });
  await download(canvas, `${name}.png`);
}
