// Runs Ultraino's published binary on an emulated ATmega2560: bytes in, ports out. Usage: mega64 BINARY.hex BYTES [CYCLES].
// Prints "port cycle value" for every write to a port in 20 periods, from CYCLES after the last byte on.
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_hex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HERTZ = 16000000, BAUD = 115200, PERIODS = 20, SYNC = 396 };

static const char PORTS[] = "ACLBKFHDGJ";
static avr_t *avr;
static uint64_t begin = UINT64_MAX;

static void written(struct avr_irq_t *irq, uint32_t value, void *port) {
    (void)irq;
    if (avr->cycle >= begin)
        printf("%c %llu %u\n", *(const char *)port, (unsigned long long)(avr->cycle - begin), value & 0xff);
}

// On the driver board, pin 2 is connected to pin 3. Timer 3 makes a wave of 396 cycles (OCR3A + 1) at pin 2, and the program
// waits for the falling edge at pin 3. The emulator does not drive the pins of timers, so this function does.
static avr_cycle_count_t toggled(struct avr_t *chip, avr_cycle_count_t when, void *pin) {
    (void)chip;
    static uint32_t level = 0;
    avr_raise_irq(pin, level ^= 1);
    return when + SYNC / 2;
}

int main(int count, char **words) {
    if (count < 3) return 2;
    ihex_chunk_t *chunks = NULL;
    int number = read_ihex_chunks(words[1], &chunks);
    FILE *file = fopen(words[2], "rb");
    if (number < 1 || !file) {
        fprintf(stderr, "%s or %s cannot be read\n", words[1], words[2]);
        return 2;
    }
    avr = avr_make_mcu_by_name("atmega2560");
    avr_init(avr);
    avr->frequency = HERTZ;
    for (int i = 0; i < number; i++) {
        if (chunks[i].baseaddr + chunks[i].size <= avr->flashend + 1)
            memcpy(avr->flash + chunks[i].baseaddr, chunks[i].data, chunks[i].size);
    }
    avr->pc = 0;
    avr->codeend = avr->flashend;
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    for (size_t i = 0; i < strlen(PORTS); i++)
        avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(PORTS[i]), IOPORT_IRQ_REG_PORT), written,
                                (void *)&PORTS[i]);
    avr_cycle_timer_register(avr, SYNC, toggled, avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('E'), 5));
    avr_irq_t *line = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    const uint64_t byte_time = (uint64_t)HERTZ * 10 / BAUD;
    uint64_t next = HERTZ / 100;
    const uint64_t pause = count > 3 ? strtoull(words[3], NULL, 10) : HERTZ / 500;
    int letter = fgetc(file);
    while (avr->cycle < begin || avr->cycle - begin < (uint64_t)PERIODS * SYNC) {
        // The program switches timer 0 off by the power reduction register, which the emulator does not implement: clear
        // TIMSK0.
        avr->data[0x6e] = 0;
        if (letter != EOF && avr->cycle >= next) {
            avr_raise_irq(line, (uint32_t)letter);
            next += byte_time;
            letter = fgetc(file);
            if (letter == EOF) begin = avr->cycle + pause;
        }
        int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            fprintf(stderr, "the program ended at cycle %llu\n", (unsigned long long)avr->cycle);
            return 1;
        }
    }
    return 0;
}
