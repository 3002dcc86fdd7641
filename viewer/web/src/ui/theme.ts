// SPDX-License-Identifier: Apache-2.0
// Colours for what is drawn on canvas: those of the style sheet, so that light and dark have one source.
import { createSignal } from 'solid-js';

export interface Theme {
  readonly ink: string; readonly dim: string; readonly faint: string; readonly line: string; readonly panel: string; readonly stripe: string;
  readonly accent: string; readonly hover: string; readonly select: string; readonly mark: string;
  readonly recorded: string; readonly latent: string; readonly augmented: string; readonly predicted: string;
  /** How executions of skills end. */
  readonly running: string; readonly success: string; readonly failure: string; readonly stopped: string; readonly lost: string;
  readonly series: readonly string[];
}

const kNames = ['ink', 'dim', 'faint', 'line', 'panel', 'stripe', 'accent', 'hover', 'select', 'mark', 'recorded', 'latent', 'augmented', 'predicted', 'running', 'success', 'failure', 'stopped', 'lost'] as const;

function read(): Theme {
  const style = getComputedStyle(document.documentElement);
  const value = (name: string) => style.getPropertyValue(`--${name}`).trim();
  return { ...(Object.fromEntries(kNames.map((name) => [name, value(name)])) as Record<(typeof kNames)[number], string>), series: Array.from({ length: 8 }, (_, i) => value(`series-${i}`)) };
}

const [theme, setTheme] = createSignal<Theme>(read());
const darkness = matchMedia('(prefers-color-scheme: dark)');
darkness.addEventListener('change', () => setTheme(read()));
addEventListener('load', () => setTheme(read()));

export { theme };
/** Changes together with the theme. */
export const isDark = (): boolean => { theme(); return darkness.matches; };
export const prefersStill = (): boolean => matchMedia('(prefers-reduced-motion: reduce)').matches;

export { kFont } from './svg';

/** Sizes a canvas for the screen's pixels and gives its context, in CSS pixels. */
export function sized(canvas: HTMLCanvasElement, width: number, height: number): CanvasRenderingContext2D {
  const ratio = window.devicePixelRatio || 1;
  const w = Math.max(1, Math.round(width * ratio));
  const h = Math.max(1, Math.round(height * ratio));
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
  }
  const context = canvas.getContext('2d')!;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}
