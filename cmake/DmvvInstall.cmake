# `cmake --install`: headers, libraries, program, the examples' sources, the schema, and a relocatable find_package(dmvv).
include(CMakePackageConfigHelpers)

# The contracts only; what a stage keeps to itself is not installed.
set(DMVV_PUBLIC_HEADERS
  authoring/bake.h authoring/distance_grid.h authoring/field.h authoring/grid_check.h authoring/molecule.h
  compiler/ir/affine.h compiler/spirv/code_cache.h compiler/compile.h compiler/plan/cost_model.h compiler/reference/explanation.h compiler/inventory.h compiler/reference/lint.h
  compiler/ir/module.h compiler/glsl/kernel.h compiler/grids/sample.h compiler/grids/storage.h compiler/ir/legend.h compiler/layout/scene_buffers.def compiler/layout/scene_buffers.h compiler/layout/resources.h
  compiler/ir/placements.h compiler/layout/atlas.h compiler/layout/flatten.h compiler/layout/lookup.h compiler/program_file.h compiler/snippet/ops.def compiler/snippet/program.h compiler/snippet/time_slot.h
  compiler/passes/seed_chains.h compiler/plan/codegen.h compiler/program.h compiler/reference/reference.h compiler/snippet/snippet.h compiler/plan/stage_options.h compiler/layout/tape_options.h
  runtime/gpu/disk_cache.h runtime/runtime.h runtime/gpu/device.h runtime/surface/prepared_surface.h runtime/view/frame_passes.def runtime/view/frame_passes.h runtime/view/picture.h runtime/view/view.h
  session/device_profile.h session/session.h session/timeline.h
  shaders/records.h
  base/diagnostic_codes.def base/diagnostics.h base/files.h voml/format.h voml/assets/grid.h base/id.h voml/assets/mesh.h base/result.h voml/scene.h)
foreach(header IN LISTS DMVV_PUBLIC_HEADERS)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dmvv/${folder})
endforeach()

install(TARGETS dmvv_base dmvv_voml dmvv_compiler dmvv_runtime dmvv_session dmvv_authoring EXPORT dmvvTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS dmvv_image_codec LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/dmvv)
install(TARGETS dmvv RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/dmvv/examples)
install(FILES spec/voml.rng DESTINATION ${CMAKE_INSTALL_DATADIR}/dmvv)

set(DMVV_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/dmvv)
install(EXPORT dmvvTargets NAMESPACE dmvv:: DESTINATION ${DMVV_PACKAGE_DIR})
configure_package_config_file(cmake/dmvvConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/dmvvConfig.cmake
  INSTALL_DESTINATION ${DMVV_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/dmvvConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dmvvConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/dmvvConfigVersion.cmake
  DESTINATION ${DMVV_PACKAGE_DIR})
