// SPDX-License-Identifier: Apache-2.0
import arrowLeft from 'lucide/dist/esm/icons/arrow-left.mjs';
import arrowRight from 'lucide/dist/esm/icons/arrow-right.mjs';
import box from 'lucide/dist/esm/icons/box.mjs';
import chartLine from 'lucide/dist/esm/icons/chart-line.mjs';
import chevronDown from 'lucide/dist/esm/icons/chevron-down.mjs';
import chevronRight from 'lucide/dist/esm/icons/chevron-right.mjs';
import chartScatter from 'lucide/dist/esm/icons/chart-scatter.mjs';
import code from 'lucide/dist/esm/icons/code.mjs';
import copy from 'lucide/dist/esm/icons/copy.mjs';
import download from 'lucide/dist/esm/icons/download.mjs';
import help from 'lucide/dist/esm/icons/circle-question-mark.mjs';
import image from 'lucide/dist/esm/icons/image.mjs';
import link from 'lucide/dist/esm/icons/link.mjs';
import listTree from 'lucide/dist/esm/icons/list-tree.mjs';
import message from 'lucide/dist/esm/icons/message-circle-question-mark.mjs';
import moon from 'lucide/dist/esm/icons/moon.mjs';
import penTool from 'lucide/dist/esm/icons/pen-tool.mjs';
import pause from 'lucide/dist/esm/icons/pause.mjs';
import play from 'lucide/dist/esm/icons/play.mjs';
import plus from 'lucide/dist/esm/icons/plus.mjs';
import radio from 'lucide/dist/esm/icons/radio.mjs';
import search from 'lucide/dist/esm/icons/search.mjs';
import skipBack from 'lucide/dist/esm/icons/skip-back.mjs';
import skipForward from 'lucide/dist/esm/icons/skip-forward.mjs';
import sparkles from 'lucide/dist/esm/icons/sparkles.mjs';
import stepBack from 'lucide/dist/esm/icons/step-back.mjs';
import stepForward from 'lucide/dist/esm/icons/step-forward.mjs';
import table from 'lucide/dist/esm/icons/table.mjs';
import terminal from 'lucide/dist/esm/icons/terminal.mjs';
import x from 'lucide/dist/esm/icons/x.mjs';

const kIcons = {
  'arrow-left': arrowLeft, 'arrow-right': arrowRight, box, 'chart-line': chartLine, 'chart-scatter': chartScatter, 'chevron-down': chevronDown, 'chevron-right': chevronRight, code, copy,
  download, help, image, link, 'list-tree': listTree, message, moon, 'pen-tool': penTool, pause, play, plus, radio, search, 'skip-back': skipBack, 'skip-forward': skipForward,
  sparkles, 'step-back': stepBack, 'step-forward': stepForward, table, terminal, x,
};
export type IconName = keyof typeof kIcons;

const kSvg = 'http://www.w3.org/2000/svg';

/** One icon of lucide, drawn in the colour of the text. */
export function Icon(props: { name: IconName }) {
  const draw = () => {
    const svg = document.createElementNS(kSvg, 'svg');
    const attributes = { viewBox: '0 0 24 24', class: 'icon', fill: 'none', stroke: 'currentColor', 'stroke-width': '2', 'stroke-linecap': 'round', 'stroke-linejoin': 'round', 'aria-hidden': 'true' };
    for (const [key, value] of Object.entries(attributes)) svg.setAttribute(key, value);
    for (const [tag, values] of kIcons[props.name]) {
      const part = document.createElementNS(kSvg, tag);
      for (const [key, value] of Object.entries(values)) part.setAttribute(key, String(value));
      svg.append(part);
    }
    return svg;
  };
  return <>{draw()}</>;
}

export function IconButton(props: { icon: IconName; label: string; onClick: () => void; isPressed?: boolean; isDisabled?: boolean }) {
  return (
    <button class="icon-button" type="button" aria-label={props.label} title={props.label} aria-pressed={props.isPressed} disabled={props.isDisabled} onClick={() => props.onClick()}>
      <Icon name={props.icon} />
    </button>
  );
}
