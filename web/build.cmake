# Builds the page and writes it as C++ source; run by the build with -DWEB=, -DNPM=, -DNODE=, -DPROTOC=, -DOUTPUT=.
# Several build directories may do this at once in the one source directory: they take turns.
file(MAKE_DIRECTORY ${WEB}/gen)
file(LOCK ${WEB}/gen/build.lock GUARD PROCESS TIMEOUT 900)

# Installing takes seconds and the network: only when the lock file is another than the one installed.
file(SHA256 ${WEB}/package-lock.json wanted)
set(installed_file ${WEB}/node_modules/.installed)
set(installed "")
if(EXISTS ${installed_file})
    file(READ ${installed_file} installed)
endif()

function(run)
    execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${WEB} RESULT_VARIABLE result)
    if(NOT result EQUAL 0)
        list(JOIN ARGV " " command)
        message(FATAL_ERROR "building the page failed: ${command}")
    endif()
endfunction()

set(ENV{PROTOC} ${PROTOC})
if(NOT installed STREQUAL wanted)
    run(${NPM} ci)
    file(WRITE ${installed_file} ${wanted})
endif()
run(${NPM} run --silent build)
run(${NODE} scripts/embed.mjs ${OUTPUT})
