# firmware_elf(board mcu app hal...): space-foosball-<board>.elf and .hex, all sources in one call of the
# compiler, since they are few and -flto looks at them together anyway.
find_program(AVR_GXX avr-g++)
find_program(AVR_OBJCOPY avr-objcopy)
find_program(AVR_SIZE avr-size)
if(NOT AVR_GXX OR NOT AVR_OBJCOPY OR NOT AVR_SIZE)
  message(FATAL_ERROR "avr-g++, avr-objcopy or avr-size is missing: install gcc-avr, binutils-avr and avr-libc "
                      "(apt-get install gcc-avr binutils-avr avr-libc), or configure with -DSF_FIRMWARE=OFF "
                      "to build without the micro-controllers' firmware and its tests.")
endif()

set(AVR_FLAGS -std=gnu++14 -DF_CPU=16000000UL -O2 -flto -Wall -Wextra -Werror -fno-exceptions -fno-rtti
              -fno-threadsafe-statics -ffunction-sections -fdata-sections -Wl,--gc-sections)

file(GLOB_RECURSE FIRMWARE_HEADERS CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/core/*.h
     ${CMAKE_CURRENT_SOURCE_DIR}/hal/*.h ${CMAKE_CURRENT_SOURCE_DIR}/app/*.h
     ${PROJECT_SOURCE_DIR}/wire/include/wire/device_*.h)

function(firmware_elf board mcu)
  set(name space-foosball-${board})
  set(elf ${CMAKE_CURRENT_BINARY_DIR}/${name}.elf)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  set(common ${FIRMWARE_CORE} app/avr_controller.cpp hal/eeprom.cpp hal/outputs.cpp hal/timing.cpp hal/watchdog.cpp)
  list(TRANSFORM common PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE core)
  add_custom_command(
    OUTPUT ${elf} ${CMAKE_CURRENT_BINARY_DIR}/${name}.hex
    COMMAND ${AVR_GXX} -mmcu=${mcu} ${AVR_FLAGS} -I${CMAKE_CURRENT_SOURCE_DIR} -I${PROJECT_SOURCE_DIR}/wire/include
            ${core} ${ARGN} -o ${elf}
    COMMAND ${AVR_OBJCOPY} -O ihex -j .text -j .data ${elf} ${CMAKE_CURRENT_BINARY_DIR}/${name}.hex
    COMMAND ${AVR_SIZE} -C --mcu=${mcu} ${elf}
    DEPENDS ${core} ${ARGN} ${FIRMWARE_HEADERS}
    COMMENT "Firmware for the ${mcu}: ${name}.elf and .hex"
    VERBATIM)
  set(FIRMWARE_ELFS ${FIRMWARE_ELFS} ${elf} PARENT_SCOPE)
endfunction()

firmware_elf(32u4 atmega32u4 hal/usb_device.cpp ${FIRMWARE_CORE_USB} app/main_32u4.cpp)
firmware_elf(2560 atmega2560 hal/twi.cpp hal/uart.cpp app/main_2560.cpp)
add_custom_target(firmware_elfs ALL DEPENDS ${FIRMWARE_ELFS})
