// SPDX-License-Identifier: Apache-2.0
import { render } from 'solid-js/web';
import { App } from './App';
import './ui/style.css';

render(() => <App />, document.getElementById('root')!);
