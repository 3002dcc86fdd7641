// SPDX-License-Identifier: Apache-2.0
import type { SvgPen } from './svg';

/** Offers a file; nothing leaves the browser. */
function offer(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Offers a canvas as a PNG file. */
export async function download(canvas: HTMLCanvasElement, name: string): Promise<void> {
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
  if (blob) offer(blob, name);
}

export const downloadSvg = (file: SvgPen | string, name: string): void => offer(new Blob([typeof file === 'string' ? file : file.text()], { type: 'image/svg+xml' }), name);
