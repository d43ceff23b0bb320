# Tests that are not one GoogleTest program of formats or lib. One block each; scripts get the folder of the
# tools as their first argument and run in a scratch folder of their own.
file(GLOB cli_tests CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} cli/*_test.cpp)
foreach(source ${cli_tests})
  tempolux_test(${source} DEPENDS tempolux_tool_main nlohmann_json::nlohmann_json)
endforeach()

# cli/probe.cpp is a tool that does nothing but what all tools share; the scripts use it next to the real ones.
add_executable(tool-probe cli/probe.cpp)
target_link_libraries(tool-probe PRIVATE tempolux_options tempolux_tool_main)
set_target_properties(tool-probe PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)

file(GLOB cli_scripts CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} cli/*_check.sh)
foreach(script ${cli_scripts})
  get_filename_component(name ${script} NAME_WE)
  add_test(NAME cli.${name} COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/cli/run.sh ${CMAKE_BINARY_DIR} ${name})
  set_tests_properties(cli.${name} PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)
endforeach()

add_test(NAME formats.read_photons COMMAND sh formats/read_photons_test.sh $<TARGET_FILE:photons_test>
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
foreach(format irradpoints irradcache)
  add_test(NAME formats.read_${format} COMMAND sh formats/read_irrad_test.sh ${format} $<TARGET_FILE:${format}_test>
           WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
add_test(NAME formats.read_radsamples COMMAND sh formats/read_radsamples_test.sh $<TARGET_FILE:radsamples_test>
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
add_test(NAME formats.read_flow COMMAND sh formats/read_flow_test.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})

add_test(NAME formats.read_paths COMMAND sh formats/read_paths_test.sh $<TARGET_FILE:paths_test>
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})

add_test(NAME formats.read_meshirrad COMMAND sh formats/read_meshirrad_test.sh $<TARGET_FILE:meshirrad_test>
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})

# Stages together, run by make at the top of the tree.
add_test(NAME pipelines.rerun COMMAND sh tests/pipelines/rerun.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.make_asks COMMAND sh tests/pipelines/make_asks.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.plan_example COMMAND sh tests/pipelines/plan_example.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.plan_refuses COMMAND sh tests/pipelines/plan_refuses.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.walkthrough COMMAND sh tests/pipelines/walkthrough.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.walkthrough PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.filter COMMAND sh tests/pipelines/filter.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.filter PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.dynamic COMMAND sh tests/pipelines/dynamic.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.dynamic PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.temporal COMMAND sh tests/pipelines/temporal.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.temporal PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.split COMMAND sh tests/pipelines/split.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.split PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.content_camera COMMAND sh tests/pipelines/content_camera.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.drop_kind COMMAND sh tests/pipelines/drop_kind.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.environment COMMAND sh tests/pipelines/environment.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.textured_room COMMAND python3 -B tests/pipelines/textured_room.py $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.scenes COMMAND sh tests/pipelines/scenes.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.installed COMMAND sh tests/pipelines/installed.sh ${CMAKE_BINARY_DIR}
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.installed PROPERTIES TIMEOUT 300 RUN_SERIAL ON)
add_test(NAME pipelines.leaving_out COMMAND sh tests/pipelines/leaving_out.sh $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.rerun pipelines.make_asks pipelines.leaving_out pipelines.plan_example pipelines.plan_refuses
                     pipelines.drop_kind pipelines.environment pipelines.scenes pipelines.textured_room PROPERTIES TIMEOUT 300)

add_test(NAME cli.no_heavy_libraries COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/cli/no_heavy_libraries.sh ${CMAKE_BINARY_DIR}/bin)

# The benchmarks' scripts still run, at tiny sizes; what they measure then means nothing.
if(TEMPOLUX_BENCH)
  set(short ${CMAKE_BINARY_DIR}/tests/bench-short)
  add_test(NAME bench.short COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/bench/short_check.sh ${CMAKE_BINARY_DIR} ${short})
  set_tests_properties(bench.short PROPERTIES TIMEOUT 600)
endif()

# Stiff and extreme cases, short form; with sanitizers what a case costs is not judged.
set(sanitized)
if(TEMPOLUX_SANITIZE)
  set(sanitized --sanitized)
endif()
add_test(NAME stress.short COMMAND python3 -B ${CMAKE_CURRENT_SOURCE_DIR}/stress/stress.py --short
                                   --bin ${CMAKE_BINARY_DIR}/bin ${sanitized})
set_tests_properties(stress.short PROPERTIES TIMEOUT 600)
