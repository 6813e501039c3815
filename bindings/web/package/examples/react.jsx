// React Three Fiber: one hook steps the physics and gives it to components.
import { createContext, use, useContext, useEffect, useMemo, useRef, useState } from 'react';
import { createRoot } from 'react-dom/client';
import { Canvas, useFrame } from '@react-three/fiber';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { mannequinGlb } from 'sinew-physics';
import { Sinew } from 'sinew-physics/three';

const Physics = createContext(null);
const usePhysics = () => useContext(Physics);
const loaded = (async () => {
  const physics = await Sinew.create();
  physics.ground();
  const bytes = mannequinGlb();
  return { physics, bytes, gltf: await new GLTFLoader().parseAsync(bytes.buffer, '') };
})();

function World({ children }) {
  const { physics } = use(loaded);
  useFrame((_, seconds) => {
    physics.update(seconds);
    window.ready = true;
  });
  return <Physics value={physics}>{children}</Physics>;
}

function Hero({ position }) {
  const physics = usePhysics();
  const { bytes, gltf } = use(loaded);
  const hero = useMemo(() => physics.character(gltf, bytes, { position }), []);
  useEffect(() => hero.stand(), [hero]);
  useEffect(() => () => physics.remove(hero), [hero]);
  return <primitive object={hero.object} onClick={() => hero.hit('chest', [0, 0, 120])} />;
}

function Crate({ position }) {
  const physics = usePhysics();
  const mesh = useRef(null);
  useEffect(() => {
    const body = physics.body(mesh.current, { mass: 10 });
    return () => physics.remove(body);
  }, []);
  return (
    <mesh ref={mesh} position={position}>
      <boxGeometry args={[0.4, 0.4, 0.4]} />
      <meshStandardMaterial color="peru" />
    </mesh>
  );
}

function App() {
  const [count, setCount] = useState(3);
  return (
    <Canvas camera={{ position: [4, 2, 5], fov: 45 }} onDoubleClick={() => setCount(count + 1)}>
      <hemisphereLight args={['white', 'gray', 3]} />
      <gridHelper args={[20, 20]} />
      <World>
        <Hero position={[0, 0, 0]} />
        <Hero position={[1.5, 0, 0]} />
        {Array.from({ length: count }, (_, i) => <Crate key={i} position={[0.1 * i, 0.3 + 0.5 * i, 2]} />)}
      </World>
    </Canvas>
  );
}

createRoot(document.getElementById('root')).render(<App />);
