// What is around the arm: meshcat's viewer, lights, ground, and when and how well it is drawn.

const SLOW = 50; // [ms] between frames, above which a moving picture is simplified
const REST = 250; // [ms] without a change, after which a simplified picture is drawn in full
const SOFTWARE = /swiftshader|llvmpipe|software/i;
const STILL = 1500; // [ms] between frames, above which a picture did not move

function drawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl");
  const named = gl && gl.getExtension("WEBGL_debug_renderer_info");
  return Boolean(named && SOFTWARE.test(gl.getParameter(named.UNMASKED_RENDERER_WEBGL)));
}

// Meshcat's viewer in an element, without its controls, lights and grid; it is drawn when `render` is called.
function meshcatViewer(pane) {
  const bySoftware = drawnBySoftware();
  let renderer = null;
  try {
    // Without a graphics card, smooth edges are made by drawing a picture that rests at twice the size.
    renderer = new THREE.WebGLRenderer({ antialias: !bySoftware, alpha: true });
    Object.assign(renderer.shadowMap, { enabled: true, type: THREE.PCFSoftShadowMap });
    renderer.outputEncoding = THREE.sRGBEncoding;
    pane.append(renderer.domElement);
  } catch (error) { // no WebGL: all else of the page goes on
    const nothing = () => {};
    renderer = { setPixelRatio: nothing, setSize: nothing, render: nothing, dispose: nothing, domElement: pane };
  }
  const onload = window.onload;
  const viewer = new MeshCat.Viewer(pane, false, renderer);
  window.onload = onload; // the viewer takes the whole window for its own
  const resize = viewer.set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = () => pane.clientWidth && pane.clientHeight && resize(pane.clientWidth, pane.clientHeight);
  viewer.bySoftware = bySoftware;
  viewer.drawing = renderer instanceof THREE.WebGLRenderer;
  viewer.gui.domElement.remove();
  for (const path of [["Lights"], ["Grid"], ["Axes"]]) viewer.delete_path(path);
  viewer.hide_background();
  viewer.camera.fov = 32;
  viewer.set_3d_pane_size();
  return viewer;
}

function lightsOf(reach) {
  const group = new THREE.Group();
  const sky = new THREE.HemisphereLight(0xffffff, 0xb4b9c0, 0.52);
  sky.position.set(0, 0, 1);
  const key = new THREE.DirectionalLight(0xfff8ef, 0.5), rim = new THREE.DirectionalLight(0xe6f0ff, 0.22);
  key.position.set(0.9, -0.9, 1.9).multiplyScalar(reach);
  rim.position.set(-1, 1.2, 0.7).multiplyScalar(reach);
  key.castShadow = true;
  key.shadow.mapSize.set(1024, 1024);
  key.shadow.radius = 5;
  key.shadow.normalBias = 0.004 * reach;
  Object.assign(key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1 * reach, far: 5 * reach });
  group.add(sky, key, key.target, rim);
  group.key = key;
  return group;
}

function groundOf(reach, height) {
  const group = new THREE.Group();
  const shadow = new THREE.Mesh(new THREE.PlaneGeometry(8 * reach, 8 * reach), new THREE.ShadowMaterial({ opacity: 0.2, depthWrite: false }));
  shadow.receiveShadow = true;
  const lines = new THREE.Mesh(new THREE.PlaneGeometry(8 * reach, 8 * reach), new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, side: THREE.DoubleSide, extensions: { derivatives: true },
    uniforms: { ink: { value: new THREE.Color() }, reach: { value: reach } },
    vertexShader: "varying vec2 at; void main() { at = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: `uniform vec3 ink; uniform float reach; varying vec2 at;
      float line(float step_) { vec2 p = at / step_, d = abs(fract(p - 0.5) - 0.5) / fwidth(p); return 1.0 - min(min(d.x, d.y), 1.0); }
      void main() { float fade = 1.0 - smoothstep(0.5 * reach, 2.4 * reach, length(at));
        gl_FragColor = vec4(ink, fade * max(0.10 * line(0.1), 0.22 * line(0.5))); }`,
  }));
  group.add(shadow, lines);
  group.position.z = height;
  group.ink = lines.material.uniforms.ink.value;
  group.shadow = shadow;
  return group;
}

// Draws when something has changed. Where that is slow, as without a graphics card, a picture that moves is drawn
// without shadows, with simpler materials and fewer triangles and pixels; as soon as it rests, in full.
class Painter {
  constructor(viewer, links, lights, ground, after) {
    Object.assign(this, { viewer, links, lights, ground, after });
    this.frames = 0; // drawn so far
    this.moving = false; // more frames are to be expected
    this._gap = viewer.bySoftware ? 1000 : 0; // [ms] between frames of a moving picture, a running mean
    this._drawn = -Infinity;
    this._fine = viewer.bySoftware ? 2 : window.devicePixelRatio;
    this._simplify(false);
    const step = (now) => {
      this._request = requestAnimationFrame(step);
      this._step(now);
    };
    step(performance.now());
  }

  stop() { cancelAnimationFrame(this._request); }

  _step(now) {
    const since = now - this._drawn;
    if (this.viewer.needs_render) {
      if (since < STILL && !this.viewer.bySoftware) this._gap += 0.3 * (since - this._gap);
      if (this._gap > SLOW && !this._simple && (this.moving || since < STILL)) this._simplify(true);
    } else if (this._simple && since > (this.moving ? STILL : REST)) this._simplify(false);
    else return;
    this.viewer.render();
    this.after();
    this.frames += 1;
    this._drawn = now;
  }

  _simplify(simple) {
    this._simple = simple;
    this.lights.key.castShadow = !simple;
    this.ground.shadow.visible = !simple;
    this.viewer.renderer.setPixelRatio(simple ? 0.75 : this._fine);
    for (const link of this.links) {
      const [geometry, material] = simple ? link.coarse : link.fine;
      Object.assign(link.mesh, { geometry, material });
      for (const ghost of link.ghost) ghost.geometry = geometry;
    }
  }
}
