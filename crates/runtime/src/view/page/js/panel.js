// Everything that is not the picture: facts, switches, time bar.

import { stageAt } from './scene.js';

const SPEEDS = [0.25, 0.5, 1, 2, 4];
const seconds = (time) => time.toFixed(2);

const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

const find = (id) => document.getElementById(id);

function fillFacts(scene) {
  find('title').textContent = scene.title;
  find('facts').append(
    ...scene.facts.flatMap(([name, value]) => [
      make('dt', { textContent: name }),
      make('dd', { textContent: value, className: value === 'success' ? 'good' : '' }),
    ]),
  );
}

function fillSwitches(scene, shown, changed) {
  const groups = [...scene.groups];
  if (scene.labels.length) groups.push({ id: 'labels', title: 'Labels', shown: true });
  for (const { id, title, shown: atFirst } of groups) {
    if (atFirst) shown.add(id);
    const box = make('input', { type: 'checkbox', checked: atFirst });
    box.addEventListener('change', () => {
      if (box.checked) shown.add(id);
      else shown.delete(id);
      changed();
    });
    find('switches').append(make('label', { className: 'switch' }, box, make('i'), title));
  }
}

function fillStages(scene) {
  const duration = scene.duration || 1;
  for (const stage of scene.stages) {
    const block = make('div', { className: 'stage' }, make('span', { textContent: stage.name }));
    block.style.left = `${(100 * stage.start) / duration}%`;
    block.style.width = `${(100 * (stage.end - stage.start)) / duration}%`;
    block.style.setProperty('--stage', stage.colour);
    find('stages').append(block);
  }
}

/** Connects the controls to the clock. `actions` are seek, changed, note, frame, theme. */
export class Panel {
  constructor(scene, clock, shown, actions) {
    this.scene = scene;
    this.clock = clock;
    fillFacts(scene);
    fillSwitches(scene, shown, actions.changed);
    fillStages(scene);
    document.body.classList.toggle('still', scene.duration === 0);
    document.body.classList.toggle('folded', window.matchMedia('(width < 900px)').matches);

    this.slider = find('time');
    this.slider.max = scene.duration;
    this.slider.addEventListener('input', () => actions.seek(Number(this.slider.value)));
    this.slider.addEventListener('change', actions.note);
    find('total').textContent = seconds(scene.duration);

    this.actions = {
      play: () => {
        clock.toggle();
        if (!clock.playing) actions.note();
      },
      loop: () => (clock.looping = !clock.looping),
      speed: () => (clock.speed = SPEEDS[(SPEEDS.indexOf(clock.speed) + 1) % SPEEDS.length]),
      frame: actions.frame,
      theme: actions.theme,
      panel: () => document.body.classList.toggle('folded'),
    };
    for (const [id, action] of Object.entries(this.actions)) {
      find(id).addEventListener('click', () => this.act(action, actions.changed));
    }
    window.addEventListener('keydown', (event) => this.key(event, actions));
    this.show();
  }

  act(action, changed) {
    action();
    this.show();
    changed();
  }

  key(event, { seek, changed }) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { clock } = this;
    const step = event.shiftKey ? 1 : 1 / 30;
    const moves = {
      ArrowLeft: () => seek(clock.time - step),
      ArrowRight: () => seek(clock.time + step),
      Home: () => seek(0),
      End: () => seek(clock.duration),
    };
    const keys = { ' ': 'play', l: 'loop', s: 'speed', f: 'frame', t: 'theme', p: 'panel' };
    const action = moves[event.key] ?? this.actions[keys[event.key]];
    if (!action || (event.key === ' ' && event.target.type === 'checkbox')) return;
    event.preventDefault();
    this.act(action, changed);
  }

  /** Shows where the clock is. */
  show() {
    const { clock, scene } = this;
    this.slider.value = clock.time;
    find('stages').style.setProperty('--at', clock.duration ? clock.time / clock.duration : 0);
    this.slider.setAttribute('aria-valuetext', `${seconds(clock.time)} s`);
    find('now').textContent = seconds(clock.time);
    find('speed').textContent = `${clock.speed}×`;
    find('loop').setAttribute('aria-pressed', clock.looping);
    find('play').classList.toggle('playing', clock.playing);
    find('play').setAttribute('aria-label', clock.playing ? 'Pause' : 'Play');
    const stage = stageAt(scene, clock.time);
    const chip = find('stage');
    chip.textContent = stage?.name ?? '';
    chip.style.setProperty('--stage', stage?.colour ?? 'transparent');
    chip.hidden = !stage;
  }
}
