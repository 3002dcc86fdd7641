// SPDX-License-Identifier: Apache-2.0
// Pictures as vectors. What draws on a canvas draws with an `SvgPen`, too, so that both pictures are
// of the same code and look the same.

/** The font of axes and legends in drawings. */
export const kFont = '11px "DejaVu Sans", "Segoe UI", system-ui, sans-serif';

/** What drawings use of a canvas. */
export interface Pen {
  fillStyle: string | CanvasGradient | CanvasPattern;
  strokeStyle: string | CanvasGradient | CanvasPattern;
  globalAlpha: number;
  lineWidth: number;
  font: string;
  textBaseline: CanvasTextBaseline;
  textAlign: CanvasTextAlign;
  save(): void;
  restore(): void;
  translate(x: number, y: number): void;
  beginPath(): void;
  closePath(): void;
  moveTo(x: number, y: number): void;
  lineTo(x: number, y: number): void;
  bezierCurveTo(x1: number, y1: number, x2: number, y2: number, x: number, y: number): void;
  rect(x: number, y: number, width: number, height: number): void;
  roundRect(x: number, y: number, width: number, height: number, radius: number): void;
  arc(x: number, y: number, radius: number, from: number, to: number): void;
  clip(): void;
  fill(): void;
  stroke(): void;
  fillRect(x: number, y: number, width: number, height: number): void;
  strokeRect(x: number, y: number, width: number, height: number): void;
  fillText(text: string, x: number, y: number): void;
  measureText(text: string): { readonly width: number };
  setLineDash(dash: number[]): void;
}

/** Leaves out letters that XML cannot hold. */
export const withoutControls = (text: string): string => text.replace(/[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]/gu, '');

/** As XML takes a text. */
export const escapeXml = (text: string): string => withoutControls(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);

const short = (value: number): string => String(Math.round(value * 100) / 100);

/** Parts of `600 11px "DejaVu Sans", sans-serif`. */
function fontOf(font: string): { weight: string; size: number; family: string } {
  const match = /^(?:(bold|\d{3}) )?([\d.]+)px (.+)$/.exec(font);
  return { weight: match?.[1] ?? 'normal', size: Number(match?.[2] ?? 10), family: match?.[3] ?? 'sans-serif' };
}

let ruler: CanvasRenderingContext2D | null | undefined;

function widthOf(text: string, font: string): number {
  if (ruler === undefined) ruler = typeof document === 'undefined' ? null : document.createElement('canvas').getContext('2d');
  if (!ruler) return text.length * fontOf(font).size * 0.6;
  ruler.font = font;
  return ruler.measureText(text).width;
}

const kBaselines: Partial<Record<CanvasTextBaseline, string>> = { middle: '0.35em', top: '0.8em' };
const kAnchors: Partial<Record<CanvasTextAlign, string>> = { center: 'middle', right: 'end', end: 'end' };
const kStyle = { fillStyle: '#000', strokeStyle: '#000', globalAlpha: 1, lineWidth: 1, font: '10px sans-serif', textBaseline: 'alphabetic', textAlign: 'start' } as const;

/** Writes shapes and texts as SVG in the place of drawing them. */
export class SvgPen implements Pen {
  fillStyle: string | CanvasGradient | CanvasPattern = kStyle.fillStyle;
  strokeStyle: string | CanvasGradient | CanvasPattern = kStyle.strokeStyle;
  globalAlpha: number = kStyle.globalAlpha;
  lineWidth: number = kStyle.lineWidth;
  font: string = kStyle.font;
  textBaseline: CanvasTextBaseline = kStyle.textBaseline;
  textAlign: CanvasTextAlign = kStyle.textAlign;
  private dash: readonly number[] = [];
  private path = '';
  private readonly body: string[] = [];
  private readonly defs: string[] = [];
  private readonly saved: { style: object; dash: readonly number[]; groups: number }[] = [];
  private groups = 0;
  private readonly hatches = new Map<string, string>();

  constructor(readonly width: number, readonly height: number, readonly title: string) {}

  save(): void {
    const style = Object.fromEntries(Object.keys(kStyle).map((key) => [key, this[key as keyof typeof kStyle]]));
    this.saved.push({ style, dash: this.dash, groups: this.groups });
  }

  restore(): void {
    const before = this.saved.pop();
    if (!before) return;
    for (; this.groups > before.groups; --this.groups) this.body.push('</g>');
    Object.assign(this, before.style);
    this.dash = before.dash;
  }

  private group(attribute: string): void {
    this.body.push(`<g ${attribute}>`);
    this.groups += 1;
  }

  /** Until `restore`. */
  translate(x: number, y: number): void { this.group(`transform="translate(${short(x)} ${short(y)})"`); }

  beginPath(): void { this.path = ''; }
  closePath(): void { this.path += 'Z'; }
  moveTo(x: number, y: number): void { this.path += `M${short(x)} ${short(y)}`; }
  lineTo(x: number, y: number): void { this.path += `${this.path === '' ? 'M' : 'L'}${short(x)} ${short(y)}`; }
  bezierCurveTo(x1: number, y1: number, x2: number, y2: number, x: number, y: number): void { this.path += `C${[x1, y1, x2, y2, x, y].map(short).join(' ')}`; }
  rect(x: number, y: number, width: number, height: number): void { this.path += `M${short(x)} ${short(y)}h${short(width)}v${short(height)}h${short(-width)}Z`; }

  roundRect(x: number, y: number, width: number, height: number, radius: number): void {
    const r = Math.min(radius, width / 2, height / 2);
    const corner = (dx: number, dy: number) => `a${short(r)} ${short(r)} 0 0 1 ${short(dx * r)} ${short(dy * r)}`;
    this.path += `M${short(x + r)} ${short(y)}h${short(width - 2 * r)}${corner(1, 1)}v${short(height - 2 * r)}${corner(-1, 1)}h${short(2 * r - width)}${corner(-1, -1)}v${short(2 * r - height)}${corner(1, -1)}Z`;
  }

  /** A whole circle: drawings here have no other arcs. */
  arc(x: number, y: number, radius: number): void {
    const half = (sign: number) => `a${short(radius)} ${short(radius)} 0 1 1 ${short(sign * 2 * radius)} 0`;
    this.path += `M${short(x - radius)} ${short(y)}${half(1)}${half(-1)}Z`;
  }

  /** Until `restore`. */
  clip(): void {
    const id = `clip${this.defs.length}`;
    this.defs.push(`<clipPath id="${id}"><path d="${this.path}"/></clipPath>`);
    this.group(`clip-path="url(#${id})"`);
  }

  private get opacity(): string { return this.globalAlpha < 1 ? ` opacity="${short(this.globalAlpha)}"` : ''; }

  fill(): void {
    if (this.path !== '') this.body.push(`<path d="${this.path}" fill="${escapeXml(String(this.fillStyle))}"${this.opacity}/>`);
  }

  stroke(): void {
    if (this.path === '') return;
    const dash = this.dash.length > 0 ? ` stroke-dasharray="${this.dash.map(short).join(' ')}"` : '';
    this.body.push(`<path d="${this.path}" fill="none" stroke="${escapeXml(String(this.strokeStyle))}" stroke-width="${short(this.lineWidth)}" stroke-linejoin="round"${dash}${this.opacity}/>`);
  }

  private alone(draw: () => void): void {
    const { path } = this;
    this.path = '';
    draw();
    this.path = path;
  }

  fillRect(x: number, y: number, width: number, height: number): void { this.alone(() => { this.rect(x, y, width, height); this.fill(); }); }
  strokeRect(x: number, y: number, width: number, height: number): void { this.alone(() => { this.rect(x, y, width, height); this.stroke(); }); }

  fillText(text: string, x: number, y: number): void {
    const { weight, size, family } = fontOf(this.font);
    const more = `${weight === 'normal' ? '' : ` font-weight="${weight}"`}${kBaselines[this.textBaseline] ? ` dy="${kBaselines[this.textBaseline]}"` : ''}${kAnchors[this.textAlign] ? ` text-anchor="${kAnchors[this.textAlign]}"` : ''}`;
    this.body.push(`<text x="${short(x)}" y="${short(y)}" font-family="${escapeXml(family)}" font-size="${short(size)}"${more} fill="${escapeXml(String(this.fillStyle))}"${this.opacity}>${escapeXml(text)}</text>`);
  }

  measureText(text: string): { width: number } { return { width: widthOf(text, this.font) }; }
  setLineDash(dash: number[]): void { this.dash = dash; }

  /** Thin diagonals in a colour, as a style to fill with. */
  hatch(colour: string): string {
    let id = this.hatches.get(colour);
    if (id === undefined) {
      id = `hatch${this.hatches.size}`;
      this.hatches.set(colour, id);
      this.defs.push(`<pattern id="${id}" width="8" height="8" patternUnits="userSpaceOnUse"><path d="M-2 10L10 -2M-2 2L2 -2M6 10L10 6" stroke="${escapeXml(colour)}" stroke-width="1.5"/></pattern>`);
    }
    return `url(#${id})`;
  }

  /** The whole file. */
  text(): string {
    const size = `width="${short(this.width)}" height="${short(this.height)}" viewBox="0 0 ${short(this.width)} ${short(this.height)}"`;
    return `<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" ${size}>\n<title>${escapeXml(this.title)}</title>\n<defs>${this.defs.join('')}</defs>\n${this.body.join('\n')}\n${'</g>'.repeat(this.groups)}</svg>\n`;
  }
}
