// SPDX-License-Identifier: Apache-2.0
import { createEffect, on, onCleanup, Show } from 'solid-js';
import { formatBytes, formatClock, formatNumber } from '../../time/format';
import { SourceTag } from '../../ui/SourceTag';
import type { Tile } from './load';

/** Frees pictures once others take their place: browsers count their pixels late, and scrubbing makes many. */
export function closeReplaced(bitmaps: () => readonly ImageBitmap[]): void {
  let shown: readonly ImageBitmap[] = [];
  const close = () => shown.forEach((bitmap) => bitmap.close());
  createEffect(on(bitmaps, (next) => { close(); shown = next; }));
  onCleanup(close);
}

/** Draws a bitmap at its own size; the style sheet scales it without smoothing. Without a label it adorns a text. */
export function Bitmap(props: { bitmap: ImageBitmap; label: string }) {
  let canvas!: HTMLCanvasElement;
  createEffect(() => {
    const { bitmap } = props;
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
    canvas.getContext('2d')!.drawImage(bitmap, 0, 0);
  });
  return <canvas ref={canvas} class="picture" role={props.label ? 'img' : undefined} aria-label={props.label || undefined} aria-hidden={props.label ? undefined : 'true'} />;
}

/** What a picture is and how good it is, in a line or two. */
export function captionOf(tile: Tile): string {
  const picture = tile.picture;
  if (!picture) return tile.title;
  const parts = [
    picture.psnr !== undefined && picture.source !== 'recorded' ? `${picture.psnr.toFixed(1)} dB` : '',
    picture.bytes !== undefined ? formatBytes(picture.bytes) : '',
    picture.range ? `black ${formatNumber(picture.range[0])}, white ${formatNumber(picture.range[1])}` : '',
    picture.gain !== undefined ? `gain ${Number(picture.gain.toPrecision(2))}` : '',
    picture.expectedError !== undefined ? `expected error ${picture.expectedError.toPrecision(2)}` : '',
    picture.bound !== undefined ? `bound ${picture.bound.toPrecision(2)}` : '',
    picture.engine ? `by ${picture.engine}` : '',
    picture.model && picture.source !== 'recorded' && picture.gain === undefined ? picture.model : '',
  ];
  return parts.filter((part) => part !== '').join(' · ');
}

export function PictureTile(props: { tile: Tile }) {
  // Where the title says the source already, the tag would say it twice.
  const tag = () => (/^(recorded|reconstructed|predicted|error map)$/i.test(props.tile.title) ? '' : props.tile.picture?.source ?? '');
  return (
    <figure class="tile">
      <div class="tile-picture">
        <Show when={props.tile.picture} fallback={<p class="missing">{props.tile.missing}</p>}>
          {(picture) => <Bitmap bitmap={picture().bitmap} label={`${props.tile.title}: ${captionOf(props.tile)}`} />}
        </Show>
      </div>
      <figcaption>
        <span class="tile-head"><strong>{props.tile.title}</strong><Show when={tag()}><SourceTag source={tag()} /></Show></span>
        <span class="muted" title={captionOf(props.tile)}>{props.tile.picture ? captionOf(props.tile) : ''}<Show when={props.tile.time !== undefined && !captionOf(props.tile)}>{formatClock(props.tile.time!)}</Show></span>
      </figcaption>
    </figure>
  );
}
