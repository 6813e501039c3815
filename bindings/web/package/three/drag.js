// Dragging with the pointer.
import { Plane, Raycaster, Vector2, Vector3 } from 'three';

/** Distance in pixels that the pointer moves before a drag starts; a shorter one is a click. */
const CLICK = 4;
/** Largest distance that a body may move between the press and the first motion of the pointer, metres. */
const REACH = 0.5;

/** @import { Camera } from 'three' */
/** @import { GrabOptions, GrabPoint } from '../index.js' */
/** @import { Picked, Sinew } from '../three.js' */

/**
 * Lets the pointer drag bodies and limbs by a spring with a bounded force. A character moved by clips goes limp when
 * grabbed, which happens once the pointer moves: a click grabs nothing. After a press on a body, the pointer's events
 * do not reach other listeners of the element, so that camera controls stay idle; `click` still does.
 */
export class SinewDrag {
  #raycaster = new Raycaster();
  #plane = new Plane();
  #pointer = new Vector2();
  #target = new Vector3();
  /** @type {GrabPoint | undefined} */
  #grab;
  /** Hit on which the pointer was pressed, and position on the page. @type {{ hit: Picked, x: number, y: number } | undefined} */
  #pressed;
  /** @type {number | undefined} */
  #pointerId;

  /**
   * @param {Sinew} physics
   * @param {Camera} camera
   * @param {HTMLElement} element The canvas.
   * @param {GrabOptions} options
   */
  constructor(physics, camera, element, options) {
    this.physics = physics;
    this.camera = camera;
    this.element = element;
    this.options = options;
    /** False: dragging is disabled. */
    this.enabled = true;
    element.addEventListener('pointerdown', this.#down, { capture: true });
    element.addEventListener('pointermove', this.#move, { capture: true });
    element.addEventListener('pointerup', this.#up, { capture: true });
    element.addEventListener('pointercancel', this.#up, { capture: true });
  }

  /** True while a body is dragged. */
  get isDragging() {
    return this.#grab !== undefined;
  }

  /** @param {PointerEvent} event */
  #aim(event) {
    const bounds = this.element.getBoundingClientRect();
    const x = (event.clientX - bounds.left) / bounds.width;
    const y = (event.clientY - bounds.top) / bounds.height;
    this.#raycaster.setFromCamera(this.#pointer.set(2 * x - 1, 1 - 2 * y), this.camera);
    return this.#raycaster.ray;
  }

  #down = (/** @type {PointerEvent} */ event) => {
    if (!this.enabled || this.#pressed || event.button !== 0) return;
    const hit = this.physics.pick(this.#aim(event));
    if (!hit || !this.#isMovable(hit)) return;
    this.#pressed = { hit, x: event.clientX, y: event.clientY };
    this.#pointerId = event.pointerId;
    event.stopImmediatePropagation();
  };

  /** @param {Picked} hit */
  #isMovable(hit) {
    return hit.character !== undefined || this.physics.world.kind(hit.body) === 'dynamic';
  }

  /** Grabs the body on which the pointer was pressed. */
  #take() {
    if (!this.#pressed) return;
    const { hit } = this.#pressed;
    if (hit.character && ['animated', 'flinching', 'gettingUp'].includes(hit.character.state)) hit.character.goLimp();
    // Going limp replaces the bodies of the character, which may also have moved since the press.
    const body = hit.character && hit.bone ? hit.character.core.body(hit.bone) : hit.body;
    if (body === undefined || !this.physics.world.hasBody(body)) return;
    this.#grab = this.physics.world.grab(body, hit.point, { reach: REACH, ...this.options });
    this.#plane.setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(this.#target), hit.point);
    this.element.setPointerCapture?.(/** @type {number} */ (this.#pointerId));
  }

  #move = (/** @type {PointerEvent} */ event) => {
    if (!this.#pressed || event.pointerId !== this.#pointerId) return;
    event.stopImmediatePropagation();
    const { x, y } = this.#pressed;
    if (!this.#grab && Math.hypot(event.clientX - x, event.clientY - y) > CLICK) this.#take();
    if (!this.#grab) return;
    if (!this.#grab.holds) return this.#release();
    const target = this.#aim(event).intersectPlane(this.#plane, this.#target);
    if (target) this.#grab.setTarget(target);
  };

  #up = (/** @type {PointerEvent} */ event) => {
    if (!this.#pressed || event.pointerId !== this.#pointerId) return;
    this.#release();
    event.stopImmediatePropagation();
  };

  #release() {
    this.#grab?.release();
    this.#grab?.free();
    this.#grab = undefined;
    this.#pressed = undefined;
  }

  /** Releases the body and removes the listeners. */
  dispose() {
    this.#release();
    for (const [type, listener] of /** @type {const} */ ([
      ['pointerdown', this.#down], ['pointermove', this.#move], ['pointerup', this.#up], ['pointercancel', this.#up],
    ])) this.element.removeEventListener(type, listener, { capture: true });
  }
}
