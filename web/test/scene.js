// A room with shapes, made in code: for the example and the tests.
import * as THREE from "three";

export function makeScene() {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xaebccc);
  const add = (geometry, color, x, y, z, turn = 0) => {
    const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color, roughness: 0.9, side: THREE.DoubleSide }));
    mesh.position.set(x, y, z);
    mesh.rotation.y = turn;
    mesh.castShadow = mesh.receiveShadow = true;
    scene.add(mesh);
    return mesh;
  };
  const wall = (width, height, color, x, y, z, turn) => add(new THREE.PlaneGeometry(width, height), color, x, y, z, turn);
  wall(6, 6, 0xd8d4cc, 0, 0, 0).rotation.x = -Math.PI / 2;
  wall(6, 3.2, 0xd8d4cc, 0, 1.6, -3);
  wall(6, 3.2, 0xb03a2e, -3, 1.6, 0, Math.PI / 2);
  wall(6, 3.2, 0x3f7f4f, 3, 1.6, 0, -Math.PI / 2);
  const knot = add(new THREE.TorusKnotGeometry(0.55, 0.19, 160, 24), 0xdfa93a, 0.1, 1.05, -0.4);
  add(new THREE.BoxGeometry(1.1, 1.8, 1.1), 0xc8c8d8, -1.6, 0.9, -1.5, 0.4);
  add(new THREE.BoxGeometry(0.9, 0.9, 0.9), 0x5a7fb0, 1.5, 0.45, -0.1, -0.35);
  add(new THREE.SphereGeometry(0.45, 48, 32), 0xe8e2d8, -1.1, 0.45, 0.6);
  add(new THREE.ConeGeometry(0.4, 1.0, 48), 0x8e5ea2, 0.6, 0.5, 1.1);
  add(new THREE.CylinderGeometry(0.12, 0.12, 2.6, 32), 0xe0e0e0, 2.2, 1.3, -2.2);
  for (let k = 0; k < 5; ++k) add(new THREE.BoxGeometry(1.6, 0.18, 0.32), 0xcfc6b8, 1.9, 0.09 + 0.18 * k, -1.2 - 0.32 * k);
  const sun = new THREE.DirectionalLight(0xfff2e0, 2.2);
  sun.position.set(2.5, 5, 4);
  sun.castShadow = true;
  Object.assign(sun.shadow, { mapSize: new THREE.Vector2(1024, 1024), normalBias: 0.03 });
  Object.assign(sun.shadow.camera, { left: -5, right: 5, top: 5, bottom: -5, far: 15 });
  scene.add(sun, new THREE.AmbientLight(0xcfdcf0, 1.3));
  return { scene, knot };
}

export function makeCamera(aspect, orthographic = false) {
  const camera = orthographic ? new THREE.OrthographicCamera(-3 * aspect, 3 * aspect, 3, -3, 1, 20) : new THREE.PerspectiveCamera(45, aspect, 1, 20);
  camera.position.set(1.2, 2.6, 6.2);
  camera.lookAt(0, 0.9, -0.6);
  camera.updateMatrixWorld();
  return camera;
}
