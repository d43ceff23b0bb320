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

# Preloaded into a tool, it lets calls that write fail (write_errors_check.sh).
add_library(fail-write MODULE cli/fail_write.cpp)
target_link_libraries(fail-write PRIVATE ${CMAKE_DL_LIBS})
set_target_properties(fail-write PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)

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

foreach(format paths meshirrad)
  add_test(NAME formats.read_${format} COMMAND sh formats/read_totals_test.sh ${format} $<TARGET_FILE:${format}_test>
           WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()

add_test(NAME formats.minor_versions COMMAND python3 -B formats/minor_versions.py
         WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})

# Ideas that the ablation leaves out still stand in the source as it has them: one that is gone leaves tests/bench/ablation_ideas.py.
add_test(NAME bench.ablation COMMAND python3 -B tests/bench/ablation.py --check WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})

add_test(NAME pipelines.advice COMMAND sh tests/pipelines/advice.sh WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})

# Stages together, run by make at the top of the tree.
foreach(script run_words rerun make_asks run_plan plan_example plan_refuses content_camera drop_kind environment
               scenes leaving_out walkthrough still filter mattes dynamic temporal preview split smoke own_scene)
  add_test(NAME pipelines.${script} COMMAND sh tests/pipelines/${script}.sh $<TARGET_FILE_DIR:scene-plan>
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(pipelines.${script} PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)
endforeach()
add_test(NAME pipelines.looks COMMAND sh tests/pipelines/looks.sh $<TARGET_FILE_DIR:scene-plan> WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.looks PROPERTIES TIMEOUT 300)
add_test(NAME pipelines.from_blender COMMAND sh tests/pipelines/from_blender.sh $<TARGET_FILE_DIR:scene-plan> WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.from_blender_module COMMAND sh tests/pipelines/from_blender.sh $<TARGET_FILE_DIR:scene-plan> build/peers/bpy/bin/python
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})   # tests/pipelines/get_bpy.sh installs it
set_tests_properties(pipelines.from_blender pipelines.from_blender_module PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)
add_test(NAME pipelines.blender_mattes COMMAND sh -c "[ -x build/peers/bpy/bin/python ] || exit 77; exec build/peers/bpy/bin/python -B tests/pipelines/blender_mattes.py $<TARGET_FILE_DIR:scene-plan>"
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.blender_mattes PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77)
# All pairs are measured by `make evidence PARTS=combinations`; each twentieth here.
add_test(NAME pipelines.combinations
         COMMAND python3 -B tests/pipelines/combinations.py $<TARGET_FILE_DIR:scene-plan> --every 20
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.combinations PROPERTIES TIMEOUT 300)
# Make against a new OUT: a random walk over what a user can change, names, ranges, two makes at once.
add_test(NAME pipelines.known_walks COMMAND python3 -B tests/pipelines/random_walk.py $<TARGET_FILE_DIR:scene-plan> --known WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.random_walk COMMAND python3 -B tests/pipelines/random_walk.py $<TARGET_FILE_DIR:scene-plan> --steps 40
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
foreach(script hostile_names same_bytes two_makes)
  add_test(NAME pipelines.${script} COMMAND python3 -B tests/pipelines/${script}.py $<TARGET_FILE_DIR:scene-plan> WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endforeach()
add_test(NAME pipelines.every_processor COMMAND python3 -B tests/pipelines/every_processor.py $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.every_processor PROPERTIES TIMEOUT 1200 SKIP_RETURN_CODE 77 COST 1000)
set_tests_properties(pipelines.known_walks pipelines.random_walk pipelines.hostile_names pipelines.same_bytes pipelines.two_makes PROPERTIES TIMEOUT 1500)
add_test(NAME pipelines.interrupted COMMAND python3 -B tests/pipelines/interrupted.py $<TARGET_FILE_DIR:scene-plan>
         --only frames,lost,again,cut,late,killed,stopped,disk
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.interrupted_methods COMMAND python3 -B tests/pipelines/interrupted.py $<TARGET_FILE_DIR:scene-plan>
         --only window,walkthrough,preview,smoke,temporal,lost,again,disk WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.jobs COMMAND python3 -B tests/pipelines/interrupted.py $<TARGET_FILE_DIR:scene-plan> --only jobs
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.interrupted pipelines.interrupted_methods pipelines.jobs PROPERTIES TIMEOUT 600)
# A queue of one command a frame: makes that share light.
add_test(NAME farm.one_frame COMMAND python3 -B tests/farm/one_frame.py $<TARGET_FILE_DIR:scene-plan> --only frames,window,walkthrough
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(farm.one_frame PROPERTIES TIMEOUT 600)
# A real Slurm on the loopback address; skipped where it is not installed.
add_test(NAME farm.slurm COMMAND python3 -B tests/farm/slurm.py $<TARGET_FILE_DIR:scene-plan> --faults 4 WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(farm.slurm PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77)
add_test(NAME pipelines.textured_room COMMAND python3 -B tests/pipelines/textured_room.py $<TARGET_FILE_DIR:scene-plan>
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME pipelines.installed COMMAND sh tests/pipelines/installed.sh ${CMAKE_BINARY_DIR}
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(pipelines.installed PROPERTIES TIMEOUT 300 RUN_SERIAL ON)
set_tests_properties(pipelines.textured_room PROPERTIES TIMEOUT 300)

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
