// SPDX-License-Identifier: Apache-2.0
import { withoutControls } from './svg';

const kProperties = ['fill', 'stroke', 'stroke-width', 'stroke-dasharray', 'font-family', 'font-size', 'font-weight', 'text-anchor'];
/** What a page needs and a picture does not. */
const kDropped = ['class', 'role', 'tabindex', 'style'];

/** A file of an SVG that is on the page: what the style sheet says is written into it. */
export function svgOf(element: SVGSVGElement, title: string, background: string): string {
  const copy = element.cloneNode(true) as SVGSVGElement;
  const shown = [...element.querySelectorAll('*')];
  [...copy.querySelectorAll('*')].forEach((part, i) => {
    const style = getComputedStyle(shown[i]!);
    // What is there for the pointer alone.
    if (style.stroke === 'rgba(0, 0, 0, 0)' || style.fill === 'rgba(0, 0, 0, 0)') return part.remove();
    if (part.tagName !== 'title' && part.tagName !== 'g') for (const name of kProperties) if (style.getPropertyValue(name)) part.setAttribute(name, style.getPropertyValue(name));
    for (const { name } of [...part.attributes]) if (kDropped.includes(name) || /^(aria|data)-/.test(name)) part.removeAttribute(name);
  });
  for (const { name } of [...copy.attributes]) if (kDropped.includes(name) || name.startsWith('aria-')) copy.removeAttribute(name);
  const make = (tag: string) => document.createElementNS('http://www.w3.org/2000/svg', tag);
  const [name, back] = [make('title'), make('rect')];
  name.textContent = title;
  for (const [key, value] of Object.entries({ width: '100%', height: '100%', fill: background })) back.setAttribute(key, value);
  copy.prepend(name, back);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${withoutControls(new XMLSerializer().serializeToString(copy))}\n`;
}
