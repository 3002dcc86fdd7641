// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { escapeXml, SvgPen } from './svg';

/** Every tag that is opened is closed, in order. */
function isNested(xml: string): boolean {
  const open: string[] = [];
  for (const [tag, close, name, end] of xml.matchAll(/<(\/?)([a-zA-Z]+)[^<>]*?(\/?)>/g)) {
    if (tag.startsWith('<?')) continue;
    if (close) { if (open.pop() !== name) return false; } else if (!end) open.push(name!);
  }
  return open.length === 0;
}

describe('a picture as SVG', () => {
  it('has shapes and texts, and no bitmap', () => {
    const pen = new SvgPen(100, 50, 'a picture');
    pen.fillStyle = '#123456';
    pen.fillRect(1, 2, 30, 40);
    pen.globalAlpha = 0.5;
    pen.setLineDash([2, 3]);
    pen.beginPath();
    pen.moveTo(0, 0);
    pen.lineTo(10.123456, 5);
    pen.stroke();
    pen.font = '600 11px "DejaVu Sans", sans-serif';
    pen.textBaseline = 'middle';
    pen.fillText('a < b', 3, 4);
    const text = pen.text();
    expect(text).toContain('<path d="M1 2h30v40h-30Z" fill="#123456"/>');
    expect(text).toContain('d="M0 0L10.12 5" fill="none" stroke="#000" stroke-width="1" stroke-linejoin="round" stroke-dasharray="2 3" opacity="0.5"');
    expect(text).toContain('font-size="11" font-weight="600" dy="0.35em"');
    expect(text).toContain('>a &#60; b</text>');
    expect(text).toContain('width="100" height="50" viewBox="0 0 100 50"');
    expect(text).not.toMatch(/<image|data:/);
    expect(isNested(text)).toBe(true);
  });

  it('closes what clips and moves, at the latest at the end', () => {
    const pen = new SvgPen(10, 10, '');
    pen.save();
    pen.translate(1, 2);
    pen.rect(0, 0, 5, 5);
    pen.clip();
    pen.fillStyle = pen.hatch('red');
    pen.fillRect(0, 0, 9, 9);
    pen.restore();
    expect(pen.fillStyle).toBe('#000');
    pen.translate(3, 3);
    const text = pen.text();
    expect(isNested(text)).toBe(true);
    expect(text).toMatch(/<clipPath id="clip0"><path d="M0 0h5v5h-5Z"\/><\/clipPath>/);
    expect(text).toContain('fill="url(#hatch0)"');
  });

  it('takes names that would be markup', () => {
    const hostile = '</text><script>alert("1")</script>&amp;\u0000\u000b\ud800';
    const pen = new SvgPen(10, 10, hostile);
    pen.fillText(hostile, 0, 0);
    pen.fillStyle = '"/><script/>';
    pen.fillRect(0, 0, 1, 1);
    expect(pen.text()).not.toMatch(/<script|\u0000|\u000b|\ud800/);
    expect(isNested(pen.text())).toBe(true);
    expect(escapeXml("'\"")).toBe('&#39;&#34;');
  });
});
