// Creates a VRM 1.0 with a swinging braid: no model of the tests has one.
import { CharacterDef } from 'sinew-physics';

const JSON_CHUNK = 0x4e4f534a;
const LINKS = 5;
const LENGTH = 0.1;

// Parts of a GLB: its JSON and its binary chunk, with the header of the latter.
function parts(glb) {
  const view = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
  const length = view.getUint32(12, true);
  if (view.getUint32(16, true) !== JSON_CHUNK) throw new Error('no GLB');
  return { json: JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + length))), rest: glb.subarray(20 + length) };
}

function whole(json, rest) {
  let text = JSON.stringify(json);
  while (text.length % 4 !== 0) text += ' ';
  const bytes = new TextEncoder().encode(text);
  const glb = new Uint8Array(20 + bytes.length + rest.length);
  const view = new DataView(glb.buffer);
  [0x46546c67, 2, glb.length, bytes.length, JSON_CHUNK].forEach((word, i) => view.setUint32(4 * i, word, true));
  glb.set(bytes, 20);
  glb.set(rest, 20 + bytes.length);
  return glb;
}

// The mannequin as a VRM whose head carries a braid.
export function withBraid(glb) {
  const def = CharacterDef.load(glb);
  const nodeOf = (bone) => def.nodes[def.boneJoints[def.bones.indexOf(bone)]];
  const { json, rest } = parts(glb);
  let above = nodeOf('head');
  const joints = [];
  for (let i = 0; i < LINKS; i++) {
    const translation = i === 0 ? [0, 0.18, -0.12] : [0, 0, -LENGTH];
    json.nodes.push({ name: `braid_${i}`, translation });
    const node = json.nodes.length - 1;
    (json.nodes[above].children ??= []).push(node);
    joints.push({ node, hitRadius: 0.02, stiffness: 0.4, gravityPower: 0.5, gravityDir: [0, -1, 0], dragForce: 0.3 });
    above = node;
  }
  const humanBones = Object.fromEntries(def.bones.map((bone) => [bone, { node: nodeOf(bone) }]));
  const meta = { name: 'mannequin', authors: ['Sinew'], licenseUrl: 'https://vrm.dev/licenses/1.0/' };
  json.extensionsUsed = [...(json.extensionsUsed ?? []), 'VRMC_vrm', 'VRMC_springBone'];
  json.extensions = {
    ...json.extensions,
    VRMC_vrm: { specVersion: '1.0', meta, humanoid: { humanBones } },
    VRMC_springBone: { specVersion: '1.0', springs: [{ name: 'braid', joints }] },
  };
  def.free();
  return whole(json, rest);
}
