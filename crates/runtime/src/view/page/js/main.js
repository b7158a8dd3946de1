import { Camera, control } from './camera.js';
import { Labels } from './labels.js';
import { Panel } from './panel.js';
import { pick } from './pick.js';
import { Renderer } from './renderer.js';
import { loadScene } from './scene.js';
import { Clock, worldPoses } from './timeline.js';

/** What the address asks for: `#t=2.5`, `#t=end`, `#theme=dark`, `#play`, joined by `&`. */
const asked = () => new URLSearchParams(location.hash.slice(1));

/** Puts a time into the address, so that it can be passed on. */
function note(time) {
  const wishes = asked();
  wishes.delete('play');
  wishes.set('t', time.toFixed(2));
  history.replaceState(null, '', `#${wishes}`);
}

function shadersOf(document) {
  const elements = [...document.querySelectorAll('script[type="x-shader"]')];
  return Object.fromEntries(elements.map((element) => [element.id, element.textContent]));
}

function start() {
  const canvas = document.getElementById('picture');
  const chip = document.getElementById('picked');
  const scene = loadScene(document);
  const camera = new Camera(scene.camera, scene.focus);
  const shaders = shadersOf(document);
  let renderer = new Renderer(canvas, scene, camera, shaders);
  const clock = new Clock(scene.duration);
  const labels = new Labels(document.getElementById('labels'), scene);
  const shown = new Set();
  let selected;
  let world = [];
  let stale = true;
  const changed = () => (stale = true);

  const seek = (time) => {
    clock.toggle(false);
    clock.seek(time);
    panel.show();
    changed();
  };
  const setTheme = (theme) => {
    document.documentElement.dataset.theme = theme;
    changed();
  };
  const panel = new Panel(scene, clock, shown, {
    seek,
    changed,
    note: () => note(clock.time),
    frame: () => camera.frame(),
    theme: () => setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'),
  });

  const draw = () => {
    if (renderer.fit()) camera.resize(canvas.clientWidth, canvas.clientHeight);
    const theme = document.documentElement.dataset.theme;
    world = worldPoses(scene.nodes, clock.time);
    renderer.draw({ world, shown, time: clock.time, camera, theme, selected });
    labels.place(world, shown, camera, canvas.clientWidth, canvas.clientHeight);
  };

  let before;
  const tick = (now) => {
    const passed = Math.min((now - (before ?? now)) / 1000, 0.1);
    before = now;
    const moving = camera.advance(passed);
    if (clock.playing) {
      clock.advance(passed);
      panel.show();
    }
    if (stale || moving || clock.playing) {
      stale = false;
      draw();
    }
    requestAnimationFrame(tick);
  };

  const hit = (event) => {
    const box = canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    return pick(scene, shown, world, camera.eye, camera.ray(x, y));
  };
  let pressed;
  canvas.addEventListener('pointerdown', (event) => (pressed = [event.clientX, event.clientY]));
  canvas.addEventListener('click', (event) => {
    if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    selected = hit(event)?.index;
    chip.hidden = selected === undefined;
    chip.textContent = scene.nodes[selected]?.name ?? '';
    changed();
  });
  canvas.addEventListener('dblclick', (event) => {
    const found = hit(event);
    if (found) camera.lookTo(found.point);
    else camera.frame();
    changed();
  });
  control(canvas, camera, changed);
  new ResizeObserver(() => draw()).observe(canvas);
  // Phones take the graphics card away from pages in the background.
  canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
  canvas.addEventListener('webglcontextrestored', () => {
    renderer = new Renderer(canvas, scene, camera, shaders);
    changed();
  });

  const follow = () => {
    const wishes = asked();
    const dark = window.matchMedia('(prefers-color-scheme: dark)').matches;
    setTheme(wishes.get('theme') ?? document.documentElement.dataset.theme ?? (dark ? 'dark' : 'light'));
    const time = wishes.get('t');
    if (time !== null) seek(time === 'end' ? scene.duration : Number(time) || 0);
    else if (wishes.has('play') || !window.matchMedia('(prefers-reduced-motion: reduce)').matches) clock.toggle(true);
    panel.show();
  };
  window.addEventListener('hashchange', follow);
  follow();
  draw();
  requestAnimationFrame(tick);
}

try {
  start();
} catch (error) {
  document.getElementById('trouble').textContent = error.message;
  document.getElementById('trouble').hidden = false;
  throw error;
}
