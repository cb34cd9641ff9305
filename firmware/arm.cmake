# firmware_uf2(board app hal...): space-foosball-<board>.elf and .uf2, as avr.cmake makes its files. No C
# library: what little is needed of one is in rp2040/startup.cpp.
find_program(ARM_GXX arm-none-eabi-g++)
find_program(ARM_SIZE arm-none-eabi-size)
find_package(Python3 REQUIRED COMPONENTS Interpreter)
if(NOT ARM_GXX OR NOT ARM_SIZE)
  message(FATAL_ERROR "arm-none-eabi-g++ or arm-none-eabi-size is missing: install gcc-arm-none-eabi "
                      "(apt-get install gcc-arm-none-eabi), or configure with -DSF_FIRMWARE=OFF to build without "
                      "the micro-controllers' firmware and its tests.")
endif()

set(ARM_FLAGS -std=gnu++17 -mcpu=cortex-m0plus -mthumb -O3 -Wall -Wextra -Werror -ffreestanding -nostdlib
              -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit -ffunction-sections
              -fdata-sections -Wl,--gc-sections)

file(GLOB ARM_HEADERS CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/rp2040/*.h
     ${PROJECT_SOURCE_DIR}/wire/include/wire/device_*.h)

function(firmware_uf2 board)
  set(name space-foosball-${board})
  set(elf ${CMAKE_CURRENT_BINARY_DIR}/${name}.elf)
  set(uf2 ${CMAKE_CURRENT_BINARY_DIR}/${name}.uf2)
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/${board}/program.ld)
  set(make_uf2 ${CMAKE_CURRENT_SOURCE_DIR}/${board}/make_uf2.py)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  add_custom_command(
    OUTPUT ${elf} ${uf2}
    COMMAND ${ARM_GXX} ${ARM_FLAGS} -I${CMAKE_CURRENT_SOURCE_DIR} -I${PROJECT_SOURCE_DIR}/wire/include
            -T ${script} ${ARGN} -lgcc -o ${elf}
    COMMAND ${Python3_EXECUTABLE} ${make_uf2} ${elf} ${uf2}
    COMMAND ${ARM_SIZE} ${elf}
    DEPENDS ${ARGN} ${script} ${make_uf2} ${FIRMWARE_HEADERS} ${ARM_HEADERS}
    COMMENT "Firmware for the ${board}: ${name}.elf and .uf2"
    VERBATIM)
  add_custom_target(firmware_uf2 ALL DEPENDS ${uf2})
endfunction()

firmware_uf2(rp2040 rp2040/boot2.cpp rp2040/startup.cpp rp2040/system.cpp rp2040/flash.cpp rp2040/i2c.cpp
             rp2040/ps2_pins.cpp rp2040/sensor_pins.cpp rp2040/usb_controller.cpp ${FIRMWARE_CORE} ${FIRMWARE_CORE_USB} ${FIRMWARE_CORE_SENSORS}
             app/main_rp2040.cpp)
