// SPDX-License-Identifier: Apache-2.0
import type { Panel } from '../../state/store';
import { Empty, PanelFrame } from '../../ui/PanelFrame';
export default function ScenePanel(props: { panel: Panel }) {
  return <PanelFrame panel={props.panel} icon="box" title="3-D scene"><Empty title="Nothing">x</Empty></PanelFrame>;
}
