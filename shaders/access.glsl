// How an evaluation reads the records that each point finds by an index of its own: from storage buffers, or from texels
// of storage texel buffers (DMVV_TEXELS; compiler/program.h: RecordAccess). Comes after shaders/records.h and the
// bindings. Set by the generator where there are such records: DMVV_LISTS, DMVV_GAPS, DMVV_PLACEMENTS, DMVV_SCALINGS,
// DMVV_PARAMETERS, DMVV_TAPES.

#ifdef DMVV_LISTS
#ifdef DMVV_TEXELS
uint cell_at(uint i) { return imageLoad(cells, int(i)).x; }
uint list_at(uint i) { return imageLoad(lists, int(i)).x; }
#else
uint cell_at(uint i) { return cells[i]; }
uint list_at(uint i) { return lists[i]; }
#endif
#endif

#ifdef DMVV_GAPS
#ifdef DMVV_TEXELS
uint gap_at(uint i) { return imageLoad(gaps, int(i)).x; }
#else
uint gap_at(uint i) { return gaps[i]; }
#endif
#endif

#ifdef DMVV_PLACEMENTS
// (object, tiled, extent, united) of a PlacementRecord
#ifdef DMVV_TEXELS
uvec4 placement_tags(uint i) { return imageLoad(placements, int(4u * i + 3u)); }
AffineRows placement_affine(uint i) {
  int row = int(4u * i);
  return AffineRows(uintBitsToFloat(imageLoad(placements, row)), uintBitsToFloat(imageLoad(placements, row + 1)),
                    uintBitsToFloat(imageLoad(placements, row + 2)));
}
#else
uvec4 placement_tags(uint i) {
  return uvec4(placements[i].object, placements[i].tiled, placements[i].extent, placements[i].united);
}
AffineRows placement_affine(uint i) { return placements[i].local_from_object; }
#endif
#endif

#ifdef DMVV_SCALINGS
#ifdef DMVV_TEXELS
vec4 scaling_at(uint i) { return uintBitsToFloat(imageLoad(scalings, int(i))); }
#else
vec4 scaling_at(uint i) { return scalings[i]; }
#endif
#endif

#ifdef DMVV_PARAMETERS
#ifdef DMVV_TEXELS
uvec4 parameter_at(uint i) { return imageLoad(parameters, int(i)); }
#else
uvec4 parameter_at(uint i) { return parameters[i]; }
#endif
#endif

#ifdef DMVV_TAPES
#ifdef DMVV_TEXELS
uint tape_cell_at(uint i) { return imageLoad(tape_cells, int(i)).x; }
uvec2 tape_at(uint i) { return imageLoad(tapes, int(i)).xy; }
#else
uint tape_cell_at(uint i) { return tape_cells[i]; }
uvec2 tape_at(uint i) { return tapes[i]; }
#endif
#endif

