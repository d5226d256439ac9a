// SPDX-License-Identifier: Apache-2.0
// Two more judges, from npm: node judges.mjs FILE, the file that spm-judges wrote. Prints a JSON list like
// its `judges`. Both count a ray's crossings by their sense, so that parts that overlap count as their
// union, whichever way they face.
import { readFileSync } from 'node:fs'
import createManifold from 'manifold-3d'
import { BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three'
import { MeshBVH } from 'three-mesh-bvh'

const MOST_LISTED = 20
const DIRECTIONS = [[0.267, 0.534, 0.802], [-0.801, 0.267, 0.535], [0.577, -0.577, 0.578]]

const { vertices, triangles, places } = JSON.parse(readFileSync(process.argv[2], 'utf8'))
const extent = Math.max(...vertices.flat().map(Math.abs))

// Inside where rays of all directions cross more often one way than the other.
function insideBy(crossings, at) {
  const counts = DIRECTIONS.map((direction) => crossings(at, direction))
  if (counts.every((count) => count === 0)) return false
  if (counts.every((count) => count === counts[0])) return true
  return null
}

function asked(judge, crossings) {
  const report = { judge, judged: 0, disagree: 0, places: [] }
  for (const place of places) {
    const inside = insideBy(crossings, place.place_m)
    if (inside === null) continue
    ++report.judged
    if (inside === place.inside || ++report.disagree > MOST_LISTED) continue
    report.places.push({ place_m: place.place_m, judge_inside: inside, answer_m: place.answer_m,
      surface_m: place.surface_m })
  }
  return report
}

async function manifoldJudge() {
  const judge = 'manifold-3d rayCast'
  const wasm = await createManifold()
  wasm.setup()
  const mesh = new wasm.Mesh({ numProp: 3, vertProperties: new Float32Array(vertices.flat()),
    triVerts: new Uint32Array(triangles.flat()) })
  mesh.merge()
  let solid
  try {
    solid = new wasm.Manifold(mesh)
  } catch (problem) {
    return { judge, not_asked: `no manifold: ${problem.message ?? problem}` }
  }
  return asked(judge, (at, direction) => {
    const end = at.map((x, axis) => x + 10 * extent * direction[axis])
    return solid.rayCast(at, end).reduce((sum, hit) => {
      const along = hit.normal[0] * direction[0] + hit.normal[1] * direction[1] + hit.normal[2] * direction[2]
      return sum + Math.sign(along)
    }, 0)
  })
}

// Whether each side is passed as often one way as the other, where vertices at one place are one.
function isClosed() {
  const at = vertices.map((vertex) => vertex.join(' '))
  const balance = new Map()
  for (const [a, b, c] of triangles) {
    for (const [from, to] of [[at[a], at[b]], [at[b], at[c]], [at[c], at[a]]]) {
      if (from === to) continue
      const [key, way] = from < to ? [`${from},${to}`, 1] : [`${to},${from}`, -1]
      balance.set(key, (balance.get(key) ?? 0) + way)
    }
  }
  return [...balance.values()].every((count) => count === 0)
}

function bvhJudge() {
  if (!isClosed()) return { judge: 'three-mesh-bvh raycast', not_asked: 'the surface is open, and rays count crossings' }
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Float64Array(vertices.flat()), 3))
  geometry.setIndex(triangles.flat())
  const bvh = new MeshBVH(geometry)
  return asked('three-mesh-bvh raycast', (at, direction) => {
    const ray = new Ray(new Vector3(...at), new Vector3(...direction).normalize())
    return bvh.raycast(ray, DoubleSide).reduce((sum, hit) => sum + Math.sign(hit.face.normal.dot(ray.direction)), 0)
  })
}

console.log(JSON.stringify([await manifoldJudge(), bvhJudge()]))
