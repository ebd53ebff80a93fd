// The player by WebGL, with three.js.

/** A view that draws a frame, or nothing where there is no WebGL. */
function webglView(canvas, data, scene, vendor) {
  const context = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
  if (!context) return null;
  const renderer = new vendor.WebGLRenderer({ canvas, context });
  const { Matrix4, Vector3, Quaternion, Color } = vendor;
  const world = new vendor.Scene();
  const camera = new vendor.PerspectiveCamera((FIELD * 180) / Math.PI, 1, 0.05, 500);
  camera.up.set(0, 0, 1);
  const sun = new vendor.DirectionalLight(0xffffff, 2.2);
  world.add(new vendor.AmbientLight(0xffffff, 1.6), sun);
  const lines = (pairs) => {
    const geometry = new vendor.BufferGeometry();
    geometry.setAttribute("position", new vendor.BufferAttribute(new Float32Array(pairs.flat(2)), 3));
    const shape = new vendor.LineSegments(geometry, new vendor.LineBasicMaterial());
    world.add(shape);
    return shape;
  };
  const instances = (geometry, count, options) => {
    const shape = new vendor.InstancedMesh(geometry, new vendor.MeshLambertMaterial(options), Math.max(1, count));
    shape.count = count;
    shape.frustumCulled = false;
    world.add(shape);
    return shape;
  };
  const floor = lines(scene.floor);
  const frames = lines(scene.cameras.flatMap((shape) => shape.lines));
  const cylinder = new vendor.CylinderGeometry(0.016, 0.016, 1, 12);
  const bones = instances(cylinder, data.bones.length, {});
  const joints = instances(new vendor.SphereGeometry(0.024, 16, 12), data.points.length, {});
  const hazes = instances(new vendor.SphereGeometry(1, 20, 14), data.points.length, { transparent: true, opacity: 0.3, depthWrite: false });
  const [matrix, at, up, turn, stretch] = [new Matrix4(), new Vector3(), new Vector3(0, 1, 0), new Quaternion(), new Vector3()];

  const place = (frame, ellipsoids) => {
    const places = data.points.map((point) => placeOf(point, frame));
    data.bones.forEach(([from, to], index) => {
      const along = minus(places[to], places[from]);
      turn.setFromUnitVectors(up, at.set(...unit(along)));
      matrix.compose(at.set(...times(add(places[from], places[to]), 0.5)), turn, stretch.set(1, Math.hypot(...along), 1));
      bones.setMatrixAt(index, matrix);
    });
    const scale = ellipsoids * ELLIPSOID_90;
    data.points.forEach((point, index) => {
      const [x, y, z] = places[index];
      joints.setMatrixAt(index, matrix.makeTranslation(x, y, z));
      const [a, b, d, c, e, f] = point.factor.map((numbers) => numbers[frame] * scale);
      hazes.setMatrixAt(index, matrix.set(a, 0, 0, x, b, d, 0, y, c, e, f, z, 0, 0, 0, 1));
    });
    hazes.visible = scale > 0;
    for (const shape of [bones, joints, hazes]) shape.instanceMatrix.needsUpdate = true;
  };
  let painted = null;
  const paint = (colours) => {
    if (painted === colours) return;
    painted = colours;
    floor.material.color.set(colours.grid);
    frames.material.color.set(colours.quiet);
    const colour = Object.fromEntries(["left", "right", "middle"].map((side) => [side, new Color(colours[side])]));
    data.bones.forEach((_, index) => bones.setColorAt(index, colour[scene.sides[index]]));
    data.points.forEach((point, index) => [joints, hazes].forEach((shape) => shape.setColorAt(index, colour[point.side])));
    for (const shape of [bones, joints, hazes]) if (shape.instanceColor) shape.instanceColor.needsUpdate = true;
  };
  return (eye, frame, ellipsoids, colours) => {
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0 || height === 0) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    const seen = eyeFrame(eye);
    camera.aspect = width / height;
    camera.position.set(...seen.place);
    camera.lookAt(...eye.target);
    camera.updateProjectionMatrix();
    sun.position.set(...add(seen.place, times(seen.up, eye.distance)));
    sun.target.position.set(...eye.target);
    sun.target.updateMatrixWorld();
    paint(colours);
    place(frame, ellipsoids);
    renderer.render(world, camera);
  };
}
